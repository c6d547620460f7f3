"""The report: one HTML file with the robots in motion, plots linked to them, and the evidence."""

from dualarm_pin.report.page import report_page, write_report
from dualarm_pin.report.result import Result, result_of

__all__ = ["Result", "report_page", "result_of", "write_report"]
