/** English, and the shape that every other language must have. */
export const en = {
  title: 'Denavit',
  robot: 'Robot',
  joints: 'Joints',
  pose: 'Pose',
  scene: '3D view of the robot',
};

export type Words = { [K in keyof typeof en]: (typeof en)[K] extends string ? string : (typeof en)[K] };
