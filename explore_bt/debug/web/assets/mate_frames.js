// Whose map lies where: robots that were told apart are drawn in the map of the one that is picked.

const SAME = { x: 0, y: 0, yaw: 0 };

/** `{T, merged}` of another robot in the picked one's map; `T` null while nobody knows. Old recordings: the same. */
export function frameOf(picked, robot) {
  if (robot === picked) return { T: SAME, merged: true };
  const mates = picked.state.newest.team?.mates;
  if (!mates) return { T: SAME, merged: true };
  const mate = mates.find((each) => each.name === robot.name);
  return mate ? { T: mate.T_ours_theirs, merged: !mate.not_merged } : { T: null, merged: false };
}

/** A place of another robot's map in the picked one's. */
export function moved(T, x, y) {
  const cos = Math.cos(T.yaw), sin = Math.sin(T.yaw);
  return [T.x + cos * x - sin * y, T.y + sin * x + cos * y];
}

/** Likewise of a pose. */
export function turned(T, pose) {
  if (!pose) return pose;
  const [x, y] = moved(T, pose.x, pose.y);
  return { ...pose, x, y, yaw: pose.yaw + T.yaw };
}
