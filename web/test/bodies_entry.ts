export * as THREE from 'three';
export { Assets } from '../src/scene/assets';
export { Bodies } from '../src/scene/bodies';
export { CameraRig } from '../src/scene/camera';
export { pickSlots } from '../src/scene/picking';
