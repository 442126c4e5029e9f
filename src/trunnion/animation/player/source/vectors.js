// The little geometry that both ways of drawing share.

export const add = (a, b, by = 1) => [a[0] + by * b[0], a[1] + by * b[1], a[2] + by * b[2]]
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
export const length = a => Math.hypot(...a)
export const unit = a => { const l = length(a) || 1; return [a[0] / l, a[1] / l, a[2] / l] }

// Points of a frame with axis e and first direction u: x along e, then u turned by the angle of rotation.
export function placed(at, axes, angle) {
  const { e, u, sense } = axes, w = cross(e, u), c = Math.cos(sense * angle), s = Math.sin(sense * angle)
  return (x, y, z) => {
    const up = y * c - z * s, side = y * s + z * c
    return [at[0] + x * e[0] + up * u[0] + side * w[0], at[1] + x * e[1] + up * u[1] + side * w[1],
      at[2] + x * e[2] + up * u[2] + side * w[2]]
  }
}

// A camera that looks at `target` from a direction given by two angles: orthographic enough to read a line, with depth.
export class Camera {
  constructor(points) {
    this.points = points
    this.reset()
  }

  reset() {
    this.turn = -0.62; this.rise = 0.36; this.zoom = 1
    this.target = [0, 0, 0]
    const { right, up, out } = this.axes
    for (const axis of [right, up, out]) {
      const seen = this.points.map(p => dot(p, axis))
      this.target = add(this.target, axis, (Math.min(...seen) + Math.max(...seen)) / 2)
    }
    this.middle = this.target
    this.known = null
  }

  // Unit vectors of the picture: to the right, up, and out of it towards the eye.
  get axes() {
    const ct = Math.cos(this.turn), st = Math.sin(this.turn), cr = Math.cos(this.rise), sr = Math.sin(this.rise)
    const out = [st * cr, -ct * cr, sr], right = [ct, st, 0]
    return { out, right, up: cross(out, right) }
  }

  // Half the height of what is seen, so that all of the line fits into a picture of that shape.
  half(aspect) {
    const { right, up } = this.axes
    const key = `${this.turn},${this.rise}`
    if (this.known?.key !== key) {
      let wide = 0, tall = 0
      for (const p of this.points) {
        const from = add(p, this.middle, -1)
        wide = Math.max(wide, Math.abs(dot(from, right))); tall = Math.max(tall, Math.abs(dot(from, up)))
      }
      this.known = { key, wide, tall }
    }
    return 1.12 * Math.max(this.known.tall, this.known.wide / aspect, 0.5) / this.zoom
  }

  // A point in the picture, −1 … 1 across its height, and how near it is to the eye.
  seen(point, aspect) {
    const { right, up, out } = this.axes, from = add(point, this.target, -1), half = this.half(aspect)
    return [dot(from, right) / half, dot(from, up) / half, dot(from, out)]
  }

  pan(x, y, aspect) {
    const { right, up } = this.axes, half = this.half(aspect)
    this.target = add(add(this.target, right, -x * half), up, -y * half)
  }
}

export function reaches(parts) {
  const found = []
  for (const part of parts) {
    const r = Math.max(part.size.radius ?? 0.1, part.size.reach ?? 0)
    for (const at of [part.at, part.far ?? part.at, add(part.at, part.axes.e, part.size.length ?? 0)]) {
      for (let k = 0; k < 3; k++) for (const s of [-1, 1]) { const p = [...at]; p[k] += s * r; found.push(p) }
    }
  }
  return found.length ? found : [[0, 0, 0]]
}
