import type { Words } from './en';

export const fr: Words = {
  title: 'Denavit',
  robot: 'Robot',
  joints: 'Articulations',
  pose: 'Pose',
  scene: 'Vue 3D du robot',
};
