// Colours of torques: blue against the twist, vermilion with it, grey where there is none; told apart by every kind of
// colour vision.

const ENDS = { light: [[0, 114, 178], [214, 214, 214], [213, 94, 0]], dark: [[86, 180, 233], [92, 96, 102], [240, 128, 40]] }

export function colour(share, theme) {
  const [low, middle, high] = ENDS[theme], end = share < 0 ? low : high
  const by = Math.min(Math.abs(share), 1)
  return [0, 1, 2].map(k => (middle[k] + by * (end[k] - middle[k])) / 255)
}

export const css = rgb => `rgb(${rgb.map(x => Math.round(255 * x)).join(",")})`

export const LOOKS = {
  light: { ground: "#f7f9fb", steel: "#9db7c9", dark: "#5b6b78", mark: "#ffffff", joint: "#c9a24b", drive: "#3d4a55",
    gear: "#c8b27a", ink: "#1a1a1a", faint: "#59636e", line: "#c5ccd3" },
  dark: { ground: "#14191f", steel: "#7d97aa", dark: "#a3b2bf", mark: "#10151a", joint: "#c9a24b", drive: "#8494a1",
    gear: "#b39d63", ink: "#e8ecf0", faint: "#a7b1bb", line: "#3d4752" },
}
