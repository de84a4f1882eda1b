"""The zenoh router that the daemon connects to, and RViz with the scanner: ros2 launch velomotion16.launch.py."""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, SetEnvironmentVariable
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    view = Path(__file__).with_name("velomotion16.rviz")
    return LaunchDescription(
        [
            DeclareLaunchArgument("router", default_value="true", description="start the zenoh router"),
            DeclareLaunchArgument("rviz", default_value="true", description="start RViz"),
            DeclareLaunchArgument("zenoh", default_value="true", description="use rmw_zenoh_cpp, not the middleware of this shell"),
            SetEnvironmentVariable("RMW_IMPLEMENTATION", "rmw_zenoh_cpp", condition=IfCondition(LaunchConfiguration("zenoh"))),
            Node(package="rmw_zenoh_cpp", executable="rmw_zenohd", condition=IfCondition(LaunchConfiguration("router"))),
            Node(package="rviz2", executable="rviz2", arguments=["-d", str(view)], condition=IfCondition(LaunchConfiguration("rviz"))),
        ]
    )
