"""ROS 2: a driver for real robots, neighbours in place of our own SLAM and controller, and a trial robot.

Importing this package imports no ROS; ``explore_bt_ros2.plugins`` does, and needs the extra ``ros2``.
"""
