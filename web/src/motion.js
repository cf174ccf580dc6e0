// The motion of a plan as a function of the time from the contact.
import {between, identityPose, poseFrom} from './kinematics.js';

/// Index of the last sample at or before a time.
function sampleBefore(times, time) {
  let low = 0;
  let high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/// The cubic through positions and rates at both ends of an interval of h seconds.
function hermite(x0, v0, x1, v1, h, s) {
  const s2 = s * s;
  const s3 = s2 * s;
  return (2 * s3 - 3 * s2 + 1) * x0 + (s3 - 2 * s2 + s) * h * v0 + (3 * s2 - 2 * s3) * x1 +
      (s3 - s2) * h * v1;
}

/// A column of poses at a time. @param record with `times`, at least two
export function sampleAt(record, column, time) {
  const i = sampleBefore(record.times, time);
  const h = record.times[i + 1] - record.times[i];
  const part = h > 0 ? Math.min(1, Math.max(0, (time - record.times[i]) / h)) : 0;
  return between(poseFrom(record[column][i]), poseFrom(record[column][i + 1]), part);
}

/// Robot and target at a time of one record of samples.
export function stateAt(record, time) {
  const {times} = record;
  const i = sampleBefore(times, time);
  const h = times[i + 1] - times[i];
  const part = h > 0 ? Math.min(1, Math.max(0, (time - times[i]) / h)) : 0;
  const joints = record.joints[i].map(
      (x, k) =>
          hermite(x, record.rates[i][k], record.joints[i + 1][k], record.rates[i + 1][k], h, part));
  return {
    joints,
    base: sampleAt(record, 'base', time),
    target: record.target.length ? sampleAt(record, 'target', time) : null,
    sample: part < 0.5 ? i : i + 1,
  };
}

/// Times of a plan, in seconds from the contact: the approach (with its wait) before zero, the
/// motion under each controller after it.
export class Motion {
  constructor(scene) {
    this.scene = scene;
    const played = record => record && record.times.length > 1;
    this.after = (scene.after ?? []).filter(played);
    this.approach = played(scene.approach) ? scene.approach : null;
    this.contact = scene.contact ?? null;
    if (this.approach) {
      const end = this.approach.times.at(-1);
      this.approach = {...this.approach, times: this.approach.times.map(t => t - end)};
    }
    this.begin = this.approach ? this.approach.times[0] : 0;
    this.end = Math.max(0, ...this.after.map(record => record.times.at(-1)));
    this.waitBegin = this.approach ? this.findWait() : 0;
  }

  /// Since when the joints are at rest before the contact.
  findWait() {
    const {rates, times} = this.approach;
    let i = rates.length - 1;
    while (i > 0 && rates[i - 1].every(rate => Math.abs(rate) < 1e-12)) --i;
    return times[i];
  }

  phase(time) {
    if (time > 0) return 'after the impact';
    if (time === 0) return 'contact';
    return time >= this.waitBegin ? 'waiting' : 'approach';
  }

  record(time, controller) {
    if (time > 0 && this.after[controller]) return this.after[controller];
    return time <= 0 ? this.approach : null;
  }

  /// The state at a time; without a record the posture at the contact, or the start.
  at(time, controller) {
    const record = this.record(time, controller);
    if (record) return stateAt(record, time);
    return this.still(this.contact ?? this.scene.start);
  }

  still(posture) {
    return {
      joints: posture.joints,
      base: posture.base ? poseFrom(posture.base) : identityPose(),
      target: posture.target ? poseFrom(posture.target) : null,
      sample: 0,
    };
  }
}
