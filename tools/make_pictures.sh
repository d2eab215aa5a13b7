#!/bin/sh
# Makes the pictures of docs/pictures_and_films.md and docs/cameras.md. Usage: tools/make_pictures.sh [path of sandlot]
set -eu
cd "$(dirname "$0")/.."
sandlot=${1:-build/sandlot}
out=docs/images
field=scenarios/msl_field.yaml

render() { "$sandlot" render "$@"; }

render $field --from 1,-16,10.5 --at 0.2,-1.2,0 --fov 68 --size 720x405 --samples 16 --time 1s --out $out/field.png
render $field --overhead --size 720x480 --samples 16 --fov 40 --time 1s --out $out/above.png
render $field --camera follow:cyan4 --size 480x320 --samples 16 --time 2s --out $out/follow.png
for plane in instances depth; do
  render $field --camera follow:cyan4 --size 480x320 --time 2s --plane $plane --out $out/$plane.png
done
render $field --camera follow:cyan4 --size 480x320 --samples 16 --time 2s --no-shadows --out $out/no_shadows.png

# Eyes of robots.
render $field --camera cyan4/omni --set vars.devices.omni.width=480 --set vars.devices.omni.height=480 --set vars.devices.omni.samples=9 \
  --time 2s --out $out/omni.png
render $field --camera cyan4/head_eye --set vars.devices.head_eye.samples=9 --time 2s --out $out/robot_camera.png
for eye in eye fisheye barrel deep gaussian shot salt hundreds pattern dead rows vignetting; do
  render tools/pictures.yaml --camera bot/$eye --time 20ms --out $out/eye_$eye.png
done
render tools/pictures.yaml --camera bot/depth/depth --time 20ms --out $out/eye_depth.png
render tools/pictures.yaml --camera bot/found/colored --time 20ms --out $out/eye_found.png
for side in left right; do
  render scenarios/stereo.yaml --camera rig/stereo/$side --time 1s --out $out/stereo_$side.png
done
tools/disparity.py $out/stereo_left.png $out/stereo_right.png $out/stereo_disparity.png
