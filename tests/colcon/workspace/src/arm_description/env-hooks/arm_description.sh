# shellcheck shell=sh
export ARM_JOINTS=6
