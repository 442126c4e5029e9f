// The player: a picture of a line in motion with what it takes to look at it. It fetches nothing, and names are text.
import { Movement } from "./motion.js"
import { Solid } from "./solid.js"
import { Flat } from "./flat.js"
import { Camera, reaches } from "./vectors.js"
import { colour, css, LOOKS } from "./colours.js"

const STYLE = `
.tp { --ground: #fff; --ink: #1a1a1a; --faint: #59636e; --line: #c5ccd3; --field: #f2f4f6; --accent: #00558a;
  font: 14px/1.45 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; color: var(--ink); background: var(--ground);
  display: flex; flex-direction: column; min-width: 0; box-sizing: border-box; height: 100%; }
.tp.dark { --ground: #1a2027; --ink: #e8ecf0; --faint: #a7b1bb; --line: #3d4752; --field: #262e37; --accent: #7cc0f0; color-scheme: dark; }
.tp * { box-sizing: border-box; }
.tp .stage { position: relative; flex: 1 1 auto; min-height: 180px; overflow: hidden; border-radius: 4px; }
.tp canvas.view { position: absolute; inset: 0; width: 100%; height: 100%; touch-action: none; cursor: grab; display: block; }
.tp canvas.view:focus-visible { outline: 3px solid var(--accent); outline-offset: -3px; }
.tp .caption { position: absolute; left: 8px; right: 8px; pointer-events: none; font-size: 13px; }
.tp .caption span { background: var(--ground); border: 1px solid var(--line); border-radius: 4px; padding: 1px 7px; display: inline-block; max-width: 100%; }
.tp .label { position: absolute; left: 0; top: 0; pointer-events: none; font-size: 12px; white-space: nowrap; padding: 0 3px;
  background: var(--ground); border-radius: 3px; opacity: .88; will-change: transform; }
.tp .label.picked { outline: 2px solid var(--accent); opacity: 1; }
.tp .controls { display: flex; flex-wrap: wrap; gap: 4px 14px; align-items: center; padding: 6px 2px 2px; }
.tp label { display: inline-flex; gap: 6px; align-items: center; color: var(--ink); min-width: 0; }
.tp label.wide { flex: 1 1 220px; }
.tp input[type=range] { accent-color: var(--accent); width: 110px; min-width: 60px; height: 24px; }
.tp label.wide input { width: 100%; flex: 1 1 auto; }
.tp button, .tp select { font: inherit; color: var(--ink); background: var(--field); border: 1px solid #7d8791; border-radius: 4px; padding: 3px 10px; min-height: 28px; cursor: pointer; max-width: 100%; }
.tp button.play { min-width: 74px; font-weight: 600; }
.tp button:focus-visible, .tp select:focus-visible, .tp input:focus-visible { outline: 3px solid var(--accent); outline-offset: 1px; }
.tp output { white-space: nowrap; font-variant-numeric: tabular-nums; color: var(--faint); min-width: 3.5em; }
.tp output.clock { min-width: 6.2em; }
.tp .legend { display: inline-flex; gap: 6px; align-items: center; font-size: 13px; font-variant-numeric: tabular-nums; }
.tp .legend i { display: inline-block; width: 120px; height: 11px; border: 1px solid var(--line); border-radius: 2px; }
.tp .said { margin: 4px 2px 0; font-size: 13px; color: var(--faint); overflow-wrap: anywhere; }
.tp .said b { color: var(--ink); }
`
const FACTORS = (() => { const f = [0]; for (let p = -3; p <= 7; p++) for (const m of [1, 2, 5]) f.push(m * 10 ** p); return f })()
const GROUND = 16
let made = 0

const round = (x, digits = 3) => {
  if (!isFinite(x)) return ""
  const text = Number(x.toPrecision(digits))
  return (Math.abs(text) >= 1e5 || (text !== 0 && Math.abs(text) < 1e-3)) ? text.toExponential(digits - 1).replace("e+", "e") : String(text)
}

function element(name, more = {}, ...inside) {
  const made = document.createElement(name)
  for (const [key, value] of Object.entries(more)) {
    if (key === "class") made.className = value
    else if (key === "text") made.textContent = value
    else if (key.startsWith("on")) made.addEventListener(key.slice(2), value)
    else made.setAttribute(key, value)
  }
  made.append(...inside)
  return made
}

class Player {
  constructor(root, data, options = {}) {
    this.root = root; this.data = data; this.options = options
    this.id = `tp${++made}`
    this.time = 0; this.speed = 1; this.names = true; this.held = false; this.chosen = 0; this.alive = true; this.picked = null
    this.calm = matchMedia("(prefers-reduced-motion: reduce)")
    this.playing = !this.calm.matches && !options.still
    this.dark = matchMedia("(prefers-color-scheme: dark)")
    this.quality = 1
    this.lately = []
    this.build()
    this.choose(Math.min(options.choice ?? 0, data.choices.length - 1))
    this.watch = new ResizeObserver(() => this.fit())
    this.watch.observe(this.stage)
    this.onTheme = () => { if (!this.options.theme && this.theme !== this.drawn_theme) this.restage() }
    this.dark.addEventListener("change", this.onTheme)
    this.dressed = new MutationObserver(this.onTheme)
    this.dressed.observe(document.documentElement, { attributes: true, attributeFilter: ["data-theme", "data-jp-theme-light"] })
    this.dressed.observe(document.body, { attributes: true, attributeFilter: ["data-jp-theme-light"] })
    this.onCalm = () => { if (this.calm.matches) this.pause() }
    this.calm.addEventListener("change", this.onCalm)
    this.step = this.step.bind(this)
    this.before = performance.now()
    requestAnimationFrame(this.step)
  }

  // What was asked for; else what the page was switched to, a notebook's included; else as the system has it.
  get theme() {
    const switched = document.documentElement.dataset.theme, notebook = document.body.dataset.jpThemeLight
    return this.options.theme ?? (["light", "dark"].includes(switched) ? switched
      : notebook === "true" ? "light" : notebook === "false" ? "dark" : this.dark.matches ? "dark" : "light")
  }

  build() {
    const field = (text, input, ...more) => element("label", {}, text, input, ...more)
    this.box = element("div", { class: "tp" })
    this.stage = element("div", { class: "stage" })
    this.over = element("div", { "aria-hidden": "true" })
    this.play_button = element("button", { class: "play", type: "button", onclick: () => this.toggle() })
    this.scrub = element("input", { type: "range", min: 0, max: 1000, step: 1, value: 0, "aria-label": "time",
      oninput: () => { this.pause(); this.seek(this.whole * this.scrub.value / 1000) } })
    this.clock = element("output", { class: "clock" })
    this.pace = element("input", { type: "range", min: -2, max: 2, step: 0.05, value: 0,
      oninput: () => { this.speed = 10 ** this.pace.value; this.sound() } })
    this.paced = element("output")
    this.factor_field = element("input", { type: "range", min: 0, max: FACTORS.length - 1, step: 1,
      oninput: () => { this.factor = FACTORS[this.factor_field.value]; this.sound(); this.draw() } })
    this.factored = element("output")
    this.hold = element("input", { type: "checkbox", onchange: () => { this.held = this.hold.checked; this.draw() } })
    this.naming = element("input", { type: "checkbox", onchange: () => { this.names = this.naming.checked; this.draw() } })
    this.select = element("select", { onchange: () => this.choose(this.select.selectedIndex) })
    for (const choice of this.data.choices) this.select.append(element("option", { text: choice.title }))
    this.by = element("select", { "aria-label": "coloured by", onchange: () => { this.key(); this.draw() } },
      element("option", { value: "torque", text: "torque" }), element("option", { value: "stress", text: "stress" }))
    this.legend = element("span", { class: "legend" })
    this.said = element("p", { class: "said", id: `${this.id}said` })
    const row = element("div", { class: "controls", role: "group", "aria-label": "playing" })
    if (this.data.choices.length > 1) row.append(field("Motion", this.select))
    const scrubbed = field("Time", this.scrub, this.clock)
    scrubbed.className = "wide"
    row.append(this.play_button, scrubbed, field("Slowed", this.pace, this.paced), field("Twist drawn", this.factor_field, this.factored))
    const second = element("div", { class: "controls", role: "group", "aria-label": "looking" },
      field(this.hold, "Hold the turning"), field(this.naming, "Names"),
      element("button", { type: "button", text: "Reset the view", onclick: () => { this.camera.reset(); this.draw() } }),
      element("button", { type: "button", text: "Save picture", onclick: () => this.picture() }))
    if (typeof MediaRecorder === "function") {
      this.film = element("button", { type: "button", text: "Save video", onclick: () => this.record() })
      second.append(this.film)
    }
    second.append(this.legend)
    this.box.append(this.stage, row, second, this.said)
    this.root.replaceChildren(element("style", { text: STYLE }), this.box)
  }

  // Another scene in the place of this one, seen from the same side.
  load(data) {
    const before = this.data.choices[this.chosen], { turn, rise, zoom } = this.camera
    this.data = data
    this.select.replaceChildren(...data.choices.map(choice => element("option", { text: choice.title })))
    const same = before.title === data.choices[0].title, share = this.time / this.whole
    this.choose(0, { turn, rise, zoom })
    if (same) this.time = share * this.whole
  }

  choose(k, from = null) {
    const choice = this.data.choices[k]
    this.chosen = k
    this.select.selectedIndex = k
    this.parts = choice.parts
    this.rows = choice.movements.map(one => new Movement(one))
    this.whole = Math.max(...this.rows.map(row => row.span))
    this.slow = choice.movements[0].slow
    this.factor = choice.movements[0].factor
    this.arbitrary = choice.movements[0].arbitrary
    this.time = 0
    let nearest = 1
    FACTORS.forEach((f, i) => { if (Math.abs(Math.log((f || 1e-9) / this.factor)) < Math.abs(Math.log((FACTORS[nearest]) / this.factor))) nearest = i })
    this.factor_field.value = nearest
    this.said.replaceChildren()
    choice.movements.forEach((one, i) => {
      if (i) this.said.append(element("br"))
      this.said.append(element("b", { text: one.title }), ` ${[one.said, ...one.notes].join(" ")}`)
    })
    const named = choice.parts.filter((p, i) => p.shape !== "tie" && choice.parts.findIndex(q => q.element === p.element && q.shape !== "tie") === i)
    this.named = named
    this.names = named.length <= 24
    this.naming.checked = this.names
    this.picked = this.picked && (named.find(part => part.name === this.picked.name) ?? null)
    this.camera = new Camera(reaches(this.parts))
    if (from) Object.assign(this.camera, from)
    this.sound()
    this.restage()
  }

  // Begins the picture anew: in WebGL, in the one context of the page, or on a plain canvas.
  restage() {
    const look = this.drawn_theme = this.theme
    this.box.classList.toggle("dark", look === "dark")
    if (this.painter instanceof Solid && !this.options.flat) this.painter.rebuild(this.parts, this.camera, look)
    else this.begin(look)
    this.canvas.setAttribute("aria-label", `${this.data.title}, ${this.data.choices[this.chosen].title}, in space. Arrow keys turn it, `
      + "plus and minus zoom, space plays and pauses, comma and full stop step, Home resets.")
    this.labels = this.named.map(part => element("span", { class: "label", text: part.name }))
    this.captions = this.rows.length > 1 ? this.rows.map(row => element("div", { class: "caption" }, element("span", { text: row.data.title + ": " + row.data.short }))) : []
    this.over.replaceChildren(...this.labels, ...this.captions)
    this.key()
    this.fit()
  }

  begin(look) {
    this.painter?.dispose()
    this.painter = null
    const blank = () => element("canvas", { class: "view", tabindex: 0, role: "application", "aria-describedby": `${this.id}said` })
    let canvas = blank()
    if (!this.options.flat) {
      try { this.painter = new Solid(canvas, this.parts, this.camera, look) } catch (error) { this.why = String(error); canvas = blank() }
    }
    if (this.painter) {
      canvas.addEventListener("webglcontextlost", event => {
        if (this.canvas !== canvas || !this.alive) return
        event.preventDefault(); this.options.flat = true; this.restage()
      })
    } else this.painter = new Flat(canvas, this.parts, this.camera, look)
    this.canvas = canvas
    this.stage.replaceChildren(canvas, this.over)
    this.listen(canvas)
  }

  get kind() { return this.painter instanceof Solid ? "webgl" : "2d" }

  // What colours the parts, the torque of their springs or the stress in those whose section is stated, and its largest
  // value, by which colours are scaled.
  get quantity() {
    const { most, unit } = this.rows[0].data, stressed = this.parts.filter(part => part.stress && part.spring >= 0)
    if (this.by.value !== "stress" || !stressed.length) return { name: "torque", most, unit, per: part => part.spring >= 0 ? 1 : null }
    const largest = Math.max(...this.rows.map(row => Math.max(...stressed.map(part => part.stress * row.largest(part.spring)))))
    return { name: "stress", most: largest / 1e6, unit: unit.replace("N m", "MPa"), per: part => part.stress && part.spring >= 0 ? part.stress / 1e6 : null }
  }

  key() {
    this.by.hidden = !this.parts.some(part => part.stress && part.spring >= 0) || !this.rows[0].data.most
    this.coloured = this.quantity
    const { name, most, unit } = this.coloured
    this.legend.replaceChildren()
    if (!most) { this.legend.append("no torque shown"); return }
    const bar = element("i", { role: "img", "aria-label": `colours from the most negative ${name} to the most positive` })
    const stops = [-1, -0.5, 0, 0.5, 1].map(x => css(colour(x, this.theme)))
    bar.style.background = `linear-gradient(90deg, ${stops.join(",")})`
    this.legend.append(...(this.by.hidden ? [`${name} `] : [this.by]), `−${round(most)}`, bar, `${round(most)} ${unit}`)
  }

  listen(canvas) {
    let from = null, moved = 0
    canvas.addEventListener("pointerdown", e => { from = [e.clientX, e.clientY]; moved = 0; canvas.setPointerCapture(e.pointerId) })
    canvas.addEventListener("pointermove", e => {
      if (!from) return
      const dx = e.clientX - from[0], dy = e.clientY - from[1]
      from = [e.clientX, e.clientY]; moved += Math.abs(dx) + Math.abs(dy)
      if (e.shiftKey || e.buttons === 4) this.camera.pan(2 * dx / this.high, -2 * dy / this.high, this.wide / this.high)
      else this.orbit(-dx * 0.008, dy * 0.008)
      this.draw()
    })
    canvas.addEventListener("pointerup", e => { if (from && moved < 5) this.pick(e); from = null })
    canvas.addEventListener("wheel", e => { if (!e.ctrlKey && document.activeElement !== canvas && this.root.getRootNode().activeElement !== canvas) return
      e.preventDefault(); this.closer(Math.exp(-e.deltaY * 0.0015)) }, { passive: false })
    canvas.addEventListener("keydown", e => {
      const keys = { ArrowLeft: () => this.orbit(-0.08, 0), ArrowRight: () => this.orbit(0.08, 0), ArrowUp: () => this.orbit(0, 0.08), ArrowDown: () => this.orbit(0, -0.08),
        "+": () => this.closer(1.15), "=": () => this.closer(1.15), "-": () => this.closer(1 / 1.15), " ": () => this.toggle(), Home: () => this.camera.reset(),
        ".": () => { this.pause(); this.seek(this.time + this.whole / 100) }, ",": () => { this.pause(); this.seek(this.time - this.whole / 100) } }
      if (!keys[e.key] || e.ctrlKey || e.metaKey || e.altKey) return
      e.preventDefault(); keys[e.key](); this.draw()
    })
  }

  orbit(turn, rise) {
    this.camera.turn += turn
    this.camera.rise = Math.min(Math.max(this.camera.rise + rise, -1.5), 1.5)
  }

  closer(by) { this.camera.zoom = Math.min(Math.max(this.camera.zoom * by, 0.3), 30); this.draw() }

  pick(event) {
    const frame = this.canvas.getBoundingClientRect(), tall = this.high / this.rows.length
    const x = event.clientX - frame.left, y = (event.clientY - frame.top) % tall
    let best = null, least = 34
    for (const part of this.named) {
      const [px, py] = this.pixel(part, tall), away = Math.hypot(px - x, py - y)
      if (away < least) { best = part; least = away }
    }
    this.picked = best
    this.options.onpick?.(best ? best.name : "")
    this.draw()
  }

  // The body of that name, or the first of what it is made of, is named whether names are shown or not.
  mark(name) {
    this.picked = this.named.find(part => part.name === name) ?? this.named.find(part => part.name.startsWith(`${name}.`)) ?? null
    if (!name) this.picked = null
    this.draw()
  }

  pixel(part, tall) {
    const middle = (part.size.length ?? 0) / 2, at = part.at.map((x, k) => x + middle * part.axes.e[k])
    const [x, y] = this.camera.seen(at, this.wide / tall)
    return [this.wide / 2 + x * tall / 2, tall / 2 - y * tall / 2]
  }

  fit() {
    const { width, height } = this.stage.getBoundingClientRect()
    if (!width || !height) return
    this.wide = width; this.high = height
    this.painter.size(width, height, Math.min(devicePixelRatio || 1, 2) * this.quality)
    this.draw()
  }

  shown(row) {
    const one = this.rows[row], { most, per, name } = this.coloured
    const angles = one.angles(this.time, this.factor, this.held), scale = name === "torque" ? one.data.most : most
    if (!one.data.springs || !scale) return { angles, shares: this.parts.map(() => null) }
    const torques = one.torques(this.time)
    return { angles, shares: this.parts.map(part => per(part) === null ? null : torques[part.spring] * per(part) / scale) }
  }

  draw() {
    if (!this.wide || !this.alive) return
    this.painter.draw(this.rows.map((_, row) => this.shown(row)))
    this.write()
    const within = this.rows[0].data.repeats && !this.rows[0].growth ? this.time % this.whole : Math.min(this.time, this.whole)
    if (document.activeElement !== this.scrub || this.playing) this.scrub.value = 1000 * within / this.whole
    this.scrub.setAttribute("aria-valuetext", `${round(within, 4)} s of ${round(this.whole, 4)} s`)
    this.clock.textContent = `${(this.rows[0].data.start + within).toPrecision(4)} s`
  }

  write() {
    const tall = this.high / this.rows.length, taken = []
    this.labels.forEach((label, i) => {
      const part = this.named[i], [x, y] = this.pixel(part, tall)
      const wide = 6.6 * part.name.length + 8, lift = GROUND + tall / this.camera.half(this.wide / tall) / 2 * Math.min(part.size.radius ?? 0.2, 0.9)
      const left = Math.min(Math.max(x - wide / 2, 2), this.wide - wide - 2)
      let spot = null
      for (const top of [y - lift, y + lift - 8, y - lift - 17, y + lift + 9, y - lift - 34]) {
        if (top > 2 && top < tall - 18 && !taken.some(b => left < b[0] + b[2] && b[0] < left + wide && top < b[1] + 16 && b[1] < top + 16)) { spot = top; break }
      }
      const own = part === this.picked
      const seen = (this.names || own) && spot !== null
      label.hidden = !seen
      label.classList.toggle("picked", own)
      if (!seen) return
      taken.push([left, spot, wide])
      label.style.transform = `translate(${left.toFixed(1)}px, ${spot.toFixed(1)}px)`
    })
    this.captions.forEach((caption, i) => { caption.style.top = `${i * tall + 6}px` })
  }

  // What the controls say of themselves.
  sound() {
    const slow = this.slow / this.speed
    this.play_button.textContent = this.playing ? "Pause" : "Play"
    this.paced.textContent = slow >= 1 ? `× 1/${round(slow, 3)}` : `× ${round(1 / slow, 3)}`
    this.pace.setAttribute("aria-valuetext", slow >= 1 ? `${round(slow, 3)} times slower than it is` : `${round(1 / slow, 3)} times faster than it is`)
    const size = this.arbitrary ? `size ${round(this.factor, 2)}` : `× ${round(this.factor, 2)}`
    this.factored.textContent = size
    this.factor_field.setAttribute("aria-valuetext", this.arbitrary ? `largest swing ${round(this.factor, 2)} rad` : `${round(this.factor, 2)} times as it is`)
  }

  toggle() { this.playing ? this.pause() : this.play() }
  play() { this.playing = true; if (!this.rows[0].data.repeats && this.time >= this.whole) this.time = 0; this.sound() }
  pause() {
    this.playing = false
    if (this.quality < 1) { this.quality = 1; this.fit() }  // a picture that rests has all its pixels
    this.sound()
  }
  seek(time) { this.time = Math.max(0, time); this.draw() }

  step(now) {
    if (!this.alive) return
    if (!this.box.isConnected) { this.absent = (this.absent ?? 0) + 1; if (this.absent > 600) return this.dispose() } else this.absent = 0
    const passed = Math.min((now - this.before) / 1000, 0.1)
    if (this.playing && this.wide && !document.hidden) {
      this.time += passed * this.speed / this.slow
      const ends = this.rows.every(row => !row.data.repeats || row.growth)
      if (ends && this.time > this.whole * 1.04) this.time = 0
      this.draw()
      this.adapt(now - this.before)
    }
    this.before = now
    requestAnimationFrame(this.step)
  }

  // Fewer pixels where frames come too slowly.
  adapt(took) {
    this.lately.push(took)
    if (this.lately.length < 30) return
    const mean = this.lately.reduce((a, b) => a + b) / this.lately.length
    this.fps = 1000 / mean
    this.lately = []
    if (mean > 30 && this.quality > 0.55) { this.quality *= 0.82; this.fit() }
  }

  save(blob, name) {
    const link = element("a", { href: URL.createObjectURL(blob), download: name })
    link.click()
    setTimeout(() => URL.revokeObjectURL(link.href), 10000)
  }

  picture() { this.draw(); this.canvas.toBlob(blob => blob && this.save(blob, "line.png")) }

  record() {
    const stream = this.canvas.captureStream(30)
    const kind = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"].find(k => MediaRecorder.isTypeSupported(k))
    if (!kind) { this.film.disabled = true; this.film.textContent = "no video here"; return }
    const recorder = new MediaRecorder(stream, { mimeType: kind, videoBitsPerSecond: 4e6 }), pieces = []
    recorder.ondataavailable = e => { if (e.data.size) pieces.push(e.data) }
    recorder.onstop = () => { this.film.disabled = false; this.film.textContent = "Save video"; this.recorded = new Blob(pieces, { type: "video/webm" }); this.save(this.recorded, "line.webm") }
    this.time = 0
    this.play()
    this.film.disabled = true
    this.film.textContent = "recording …"
    recorder.start()
    setTimeout(() => recorder.stop(), 1000 * Math.min(Math.max(this.whole * this.slow / this.speed, 2), 15))
  }

  // What the bodies of a row really stand at, by the picture.
  read(row = 0) {
    this.painter.draw([this.shown(row)])
    const found = this.painter.read()
    this.draw()
    return found.map((angles, i) => ({ name: this.parts[i].name, shape: this.parts[i].shape, angles }))
  }

  colours(row = 0) {
    this.painter.draw([this.shown(row)])
    const found = (this.painter.bodies ?? []).map(body => body.tint ? body.tint.getHexString() : "")
    this.draw()
    return found
  }

  dispose() {
    if (!this.alive) return
    this.alive = false
    this.watch.disconnect()
    this.dressed.disconnect()
    this.dark.removeEventListener("change", this.onTheme)
    this.calm.removeEventListener("change", this.onCalm)
    this.painter.dispose()
  }
}

export function mount(root, data, options = {}) {
  root.player?.dispose()
  const player = new Player(root, data, options)
  root.player = player
  return player
}

// For a page that holds its scene as data, and a place for it.
export function start() {
  const data = JSON.parse(document.getElementById("trunnion-scene").textContent)
  const flat = new URLSearchParams(location.search).has("flat")
  return mount(document.getElementById("trunnion-player"), data, { flat })
}

// For Panel and anywidget: the model holds the scene as text.
export function render({ model, el }) {
  const own = typeof model.get === "function" && !("scene" in model)
  const get = key => own ? model.get(key) : model[key]
  const root = document.createElement("div")
  root.style.cssText = `width: 100%; height: ${get("height_of") ?? 520}px`
  if (own) el.append(root)
  let player = null
  const show = () => {
    const text = get("scene")
    if (!text) { player?.dispose(); player = null; root.replaceChildren(); root.style.display = "none"; return }
    root.style.display = ""
    if (player) { player.options.theme = get("theme") || undefined; player.load(JSON.parse(text)); player.mark(get("picked") ?? ""); return }
    player = mount(root, JSON.parse(text), { theme: get("theme") || undefined, flat: get("flat") || false, choice: get("choice") ?? 0,
      onpick: name => { if (own) { model.set("picked", name); model.save_changes() } else model.picked = name } })
    player.mark(get("picked") ?? "")
  }
  show()
  model.on(own ? "change:scene" : "scene", show)
  model.on(own ? "change:theme" : "theme", show)
  model.on(own ? "change:picked" : "picked", () => player?.mark(get("picked")))
  if (!own) model.on("remove", () => player?.dispose())
  return own ? () => player?.dispose() : root
}
