#!/usr/bin/env python3
"""Send a goal file to the controller of both arms: send_goal.py both.goal.yaml [ACTION]."""

import sys

import rclpy
import yaml
from builtin_interfaces.msg import Duration
from control_msgs.action import FollowJointTrajectory
from rclpy.action import ActionClient
from trajectory_msgs.msg import JointTrajectoryPoint

ACTION = "/both_arms_controller/follow_joint_trajectory"


def goal_of(file):
    """Return the goal that stands in a file."""
    with open(file, encoding="utf-8") as stream:
        content = yaml.load(stream, getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    goal = FollowJointTrajectory.Goal()
    goal.trajectory.joint_names = content["trajectory"]["joint_names"]
    for point in content["trajectory"]["points"]:
        goal.trajectory.points.append(
            JointTrajectoryPoint(
                positions=point["positions"],
                velocities=point["velocities"],
                accelerations=point["accelerations"],
                time_from_start=Duration(**point["time_from_start"]),
            )
        )
    goal.goal_time_tolerance = Duration(**content["goal_time_tolerance"])
    return goal


def main(file, action=ACTION):
    """Send it, wait for the end and return 0 if the controller reached it."""
    goal = goal_of(file)
    rclpy.init()
    node = rclpy.create_node("dualarm_pin_sender")
    try:
        client = ActionClient(node, FollowJointTrajectory, action)
        if not client.wait_for_server(timeout_sec=5.0):
            print(f"no controller answers at {action}", file=sys.stderr)
            return 1
        sent = client.send_goal_async(goal)
        rclpy.spin_until_future_complete(node, sent)
        if not sent.result().accepted:
            print("the controller refused the goal", file=sys.stderr)
            return 1
        done = sent.result().get_result_async()
        rclpy.spin_until_future_complete(node, done)
        result = done.result().result
        print(result.error_string or f"error code {result.error_code}")
        return 0 if result.error_code == FollowJointTrajectory.Result.SUCCESSFUL else 1
    finally:
        node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
