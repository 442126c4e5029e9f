// What a line does at a time: angles of its stations and torques of its springs, between the frames that were computed.

const at = (series, i) => typeof series === "number" ? series : series[i]

const between = (series, i, share) => typeof series === "number" ? series
  : series[i] + share * (series[i + 1] - series[i])

export class Movement {
  constructor(data) {
    this.data = data
    this.frames = data.frames
    this.period = data.end - data.start
    this.growth = data.growth
    // A disturbance is followed until it is ten times as large, or a tenth; what repeats, for ever.
    this.span = data.span ?? this.period
    this.unit = 1
    if (this.growth && this.growth[0] > 0) this.unit = Math.exp(-this.growth[0] * this.span)
  }

  // The frame before a time (counted from the start, in seconds), the share of the way to the next, and periods gone by.
  place(time) {
    let periods = 0, within = time
    if (this.data.repeats) { periods = Math.floor(time / this.period); within = time - periods * this.period }
    const x = Math.min(Math.max(within / this.period, 0), 1) * (this.frames - 1)
    const i = Math.min(Math.floor(x), this.frames - 2)
    return { i, share: x - i, periods }
  }

  envelope(time) {
    if (!this.growth) return null
    const size = this.unit * Math.exp(this.growth[0] * time), turn = this.growth[1] * time
    return [size * Math.cos(turn), size * Math.sin(turn)]
  }

  // Re[part · e^{λt}] of a series, or the series itself.
  value(part, k, where, wave) {
    if (!wave) return between(part[k], where.i, where.share)
    const re = between(part.re[k], where.i, where.share), im = between(part.im[k], where.i, where.share)
    return re * wave[0] - im * wave[1]
  }

  // Angles as drawn: the rigid part, left out where the turning is held, and the deviation times the factor.
  angles(time, factor, held) {
    const where = this.place(time), wave = this.envelope(time), found = new Float64Array(this.data.rigid.length)
    for (let s = 0; s < found.length; s++) {
      const rigid = this.data.rigid[s]
      let angle = held ? at(rigid, 0) : between(rigid, where.i, where.share)
      if (!held && where.periods) angle += where.periods * (at(rigid, this.frames - 1) - at(rigid, 0))
      found[s] = angle + factor * this.value(this.data.deviation, s, where, wave)
    }
    return found
  }

  // The largest size of the torque of a spring; of what grows, at its largest.
  largest(e) {
    const { torque } = this.data, series = part => typeof part === "number" ? [part] : part
    if (!this.growth) return Math.max(...series(torque[e]).map(Math.abs))
    const re = series(torque.re[e]), im = series(torque.im[e])
    return Math.max(...Array.from({ length: Math.max(re.length, im.length) }, (_, k) => Math.hypot(re[k] ?? re[0], im[k] ?? im[0])))
  }

  torques(time) {
    const where = this.place(time), wave = this.envelope(time)
    const count = this.data.springs
    const found = new Float64Array(count)
    for (let e = 0; e < count; e++) found[e] = this.value(this.data.torque, e, where, wave)
    return found
  }
}
