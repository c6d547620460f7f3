"""Robots of example-robot-data as cells: single arms loaded twice, and both arms in one URDF.

Each row: id, URDF below `robots/`, tips, joints of the two arms, columns of q in all.
"""

from __future__ import annotations

import pytest

from dualarm_pin.robot.packages import robot_data_share

SINGLE = [
    ("panda", "panda_description/urdf/panda.urdf", "panda_hand_tcp", 7),
    ("panda_collision", "panda_description/urdf/panda_collision.urdf", "panda_hand_tcp", 7),
    ("ur3", "ur_description/urdf/ur3_robot.urdf", "tool0", 6),
    ("ur5", "ur_description/urdf/ur5_robot.urdf", "tool0", 6),
    ("ur10", "ur_description/urdf/ur10_robot.urdf", "tool0", 6),
    ("ur3_limited", "ur_description/urdf/ur3_joint_limited_robot.urdf", "tool0", 6),
    ("ur5_limited", "ur_description/urdf/ur5_joint_limited_robot.urdf", "tool0", 6),
    ("ur10_limited", "ur_description/urdf/ur10_joint_limited_robot.urdf", "tool0", 6),
    ("ur3_gripper", "ur_description/urdf/ur3_gripper.urdf", "tool0", 6),
    ("ur5_gripper", "ur_description/urdf/ur5_gripper.urdf", "tool0", 6),
    ("kinova", "kinova_description/robots/kinova.urdf", "j2s6s200_end_effector", 6),
    ("xarm7", "xarm_description/urdf/xarm7.urdf", "link_eef", 7),
    ("z1", "z1_description/urdf/z1.urdf", "gripperStator", 6),
    ("so100", "so_arm_description/urdf/so100.urdf", "gripper", 5),
    ("so101", "so_arm_description/urdf/so101.urdf", "gripper_frame_link", 5),
    ("tiago_no_hand", "tiago_description/robots/tiago_no_hand.urdf", "wrist_ft_tool_link", 8),
    (
        "anymal-kinova",
        "anymal_b_simple_description/robots/anymal-kinova.urdf",
        "j2s6s200_end_effector",
        6,
    ),
    ("b1-z1", "b1_description/urdf/b1-z1.urdf", "gripperStator", 6),
    ("talos_left_arm", "talos_data/robots/talos_left_arm.urdf", "gripper_left_base_link", 6),
    (
        "hextilt",
        "hextilt_description/urdf/hextilt_flying_arm_5.urdf",
        "flying_arm_5__gripper",
        5,
    ),
    ("finger_edu", "finger_edu_description/robots/finger_edu.urdf", "finger_tip_link", 3),
    (
        "borinot",
        "borinot_description/urdf/borinot_flying_arm_2.urdf",
        "flying_arm_2__ee",
        2,
    ),
]
TWIN = [
    ("baxter", "baxter_description/urdf/baxter.urdf", ("left_gripper", "right_gripper"), 7),
    ("pr2", "pr2_description/urdf/pr2.urdf", ("l_gripper_tool_frame", "r_gripper_tool_frame"), 7),
    *[
        (
            name,
            f"{name}_description/robots/{name}.urdf",
            ("arm_left_tool_link", "arm_right_tool_link"),
            7,
        )
        for name in ("tiago_pro",)
    ],
    (
        "tiago_dual",
        "tiago_description/robots/tiago_dual.urdf",
        ("arm_left_tool_link", "arm_right_tool_link"),
        7,
    ),
    *[
        (
            name,
            f"talos_data/robots/{name}.urdf",
            ("gripper_left_base_link", "gripper_right_base_link"),
            7,
        )
        for name in (
            "talos_reduced",
            "talos_reduced_corrected",
            "talos_reduced_box",
            "talos_full_v2",
            "talos_full_v2_box",
        )
    ],
    (
        "g1_29dof",
        "g1_description/urdf/g1_29dof_rev_1_0.urdf",
        ("left_rubber_hand", "right_rubber_hand"),
        7,
    ),
    (
        "g1_with_hand",
        "g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf",
        ("left_hand_palm_link", "right_hand_palm_link"),
        7,
    ),
    *[
        (name, f"icub_description/robots/{name}.urdf", ("l_hand_dh_frame", "r_hand_dh_frame"), 7)
        for name in ("icub", "icub_reduced")
    ],
    ("romeo", "romeo_description/urdf/romeo.urdf", ("l_gripper", "r_gripper"), 7),
    ("romeo_small", "romeo_description/urdf/romeo_small.urdf", ("l_gripper", "r_gripper"), 7),
    ("romeo_laas", "romeo_description/urdf/romeo_laas_small.urdf", ("l_gripper", "r_gripper"), 8),
    ("centauro", "centauro_description/urdf/centauro.urdf", ("ball1_tip", "ball2_tip"), 6),
    ("alex_nub", "alex_description/urdf/alex_nub_hands.urdf", ("leftNub", "rightNub"), 7),
    *[
        (
            f"alex_{hand}",
            f"alex_description/urdf/alex_{hand}_hands.urdf",
            ("LeftGripperYawLink", "RightGripperYawLink"),
            7,
        )
        for hand in ("sake", "psyonic")
    ],
    *[
        (name, f"simple_humanoid_description/urdf/{name}.urdf", ("l_wrist", "r_wrist"), 7)
        for name in ("simple_humanoid", "simple_humanoid_classical")
    ],
    ("human", "human_description/robots/human.urdf", ("left_hand", "right_hand"), 8),
]
NAMES = [row[0] for row in SINGLE + TWIN]

needs_robots = pytest.mark.skipif(
    robot_data_share() is None, reason="needs the extra 'robots' (example-robot-data)"
)


def arguments(name: str) -> tuple[list[str], dict[str, tuple[str, str]], int]:
    """Return what Cell.from_urdf takes for a robot, and its number of columns."""
    for robot, urdf, tip, dofs in SINGLE:
        if robot == name:
            file = f"package://example-robot-data/robots/{urdf}"
            return [file, file], {"tips": (tip, tip)}, 2 * dofs
    for robot, urdf, tips, dofs in TWIN:
        if robot == name:
            return [f"package://example-robot-data/robots/{urdf}"], {"tips": tips}, 2 * dofs
    raise KeyError(name)
