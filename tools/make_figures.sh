#!/bin/sh
# Draws the figures of docs/motors.md from runs of the scenarios beside them. Usage: tools/make_figures.sh [path of sandlot]
set -eu
cd "$(dirname "$0")/.."
sandlot=${1:-build/sandlot}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

wheel=joints.left_wheel_joint.velocity
"$sandlot" run scenarios/motor_ramp.yaml --headless --log "$work/ramp.csv" --log-values \
"gains_p/left_motor.target,gains_p.$wheel,gains_p_high.$wheel,gains_pi.$wheel,gains_pi_high.$wheel"
"$sandlot" plot "$work/ramp.csv" --title "Target and achieved speed of a wheel" --y-label "speed [rad/s]" --x-range 0.5,7.5 \
  --label target --label "p 0.4" --label "p 2" --label "p 0.4, i 4" --label "p 2, i 12" \
  --color red --color blue --color green --color orange --color purple --out docs/images/motor_ramp.svg

"$sandlot" run scenarios/joint_step.yaml --headless --log "$work/step.csv" --log-values \
"soft/joint1.reference,soft.joints.joint1.position,tight.joints.joint1.position,damped.joints.joint1.position"
"$sandlot" plot "$work/step.csv" --title "A step of a joint from 0.5 rad to 0" --y-label "angle [rad]" --x-range 1.9,3 \
  --label reference --label "p 2, d 0.05" --label "p 20, d 0.2" --label "p 20, d 2" \
  --color red --color blue --color green --color orange --out docs/images/joint_step.svg
