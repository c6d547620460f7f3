"""The compiled engine: closed-form kinematics and a structured interior point for the whole path.

Nothing is imported here, so that numba is loaded only by those who solve: use
`dualarm_pin.engine.solve` (the Python face) and `dualarm_pin.engine.chain`.
"""
