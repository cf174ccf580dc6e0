// The gap between the two bodies that are closest to each other: a line between their nearest
// points, and its length as a label that follows the camera.
import {CylinderGeometry, Group, Mesh, MeshBasicMaterial, SphereGeometry, Vector3} from 'three';

import {fixed, h} from './dom.js';
import {kY} from './shapes.js';

export class Gap {
  /// @param reach of the robot, m
  constructor(reach) {
    this.material = new MeshBasicMaterial({depthTest: false, transparent: true});
    const radius = 0.004 * reach;
    const solid = geometry => {
      const mesh = new Mesh(geometry, this.material);
      mesh.renderOrder = 3;
      return mesh;
    };
    this.line = solid(new CylinderGeometry(radius, radius, 1, 10));
    this.ends = [0, 1].map(() => solid(new SphereGeometry(2 * radius, 12, 8)));
    this.group = new Group().add(this.line, ...this.ends);
    this.group.visible = false;
    this.label = h('output', {class: 'gap', hidden: true});
  }

  /// @param points on both bodies in N, or null @param distance m
  show(points, distance) {
    this.group.visible = points !== null;
    if (!points) return;
    const [from, to] = points;
    const along = to.clone().sub(from);
    this.ends[0].position.copy(from);
    this.ends[1].position.copy(to);
    this.line.position.copy(from).addScaledVector(along, 0.5);
    this.line.scale.y = Math.max(along.length(), 1e-6);
    this.line.quaternion.setFromUnitVectors(kY, along.normalize());
    this.label.textContent = `${fixed(distance, 3)} m`;
  }

  /// After the scene was drawn by a camera in a frame of so many pixels.
  follow(camera, width, height) {
    const at = this.line.getWorldPosition(new Vector3()).project(camera);
    const inside = Math.abs(at.x) < 0.98 && Math.abs(at.y) < 0.98 && at.z < 1;
    this.label.hidden = !this.group.visible || !inside;
    if (this.label.hidden) return;
    // Towards the middle, so that it does not leave the frame.
    const right = at.x > 0.4;
    this.label.style.left = `${(at.x + 1) / 2 * width}px`;
    this.label.style.top = `${(1 - at.y) / 2 * height}px`;
    this.label.classList.toggle('left', right);
  }
}
