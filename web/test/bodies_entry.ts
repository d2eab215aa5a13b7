export * as THREE from 'three';
export { Assets } from '../src/scene/assets';
export { Bodies } from '../src/scene/bodies';
export { Between, mixAngle, mixRecords, mixTurn, Way } from '../src/scene/between';
export { CameraRig } from '../src/scene/camera';
export { pickSlots } from '../src/scene/picking';
