#!/bin/sh
# Draws the figures of docs/motors.md from runs of the scenarios beside them. Usage: tools/make_figures.sh [path of sandlot]
set -eu
cd "$(dirname "$0")/.."
sandlot=${1:-build/sandlot}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$sandlot" run scenarios/motor_ramp.yaml --headless --log "$work/ramp.csv" --log-values \
"gains_p/left_motor.target,gains_p.joints.left_wheel_joint.velocity,gains_p_high.joints.left_wheel_joint.velocity,\
gains_pi.joints.left_wheel_joint.velocity,gains_pi_high.joints.left_wheel_joint.velocity"
"$sandlot" plot "$work/ramp.csv" --title "Target and achieved speed of a wheel" --y-label "speed [rad/s]" \
  --label target --label "p 0.05" --label "p 0.4" --label "p 0.2, i 2" --label "p 0.4, i 12" --out docs/images/motor_ramp.svg

"$sandlot" run scenarios/joint_step.yaml --headless --log "$work/step.csv" --log-values \
"soft.joints.joint1.position,tight.joints.joint1.position,damped.joints.joint1.position"
"$sandlot" plot "$work/step.csv" --title "A step of a joint from 0.5 rad to 0" --y-label "position [rad]" \
  --label soft --label tight --label damped --out docs/images/joint_step.svg
