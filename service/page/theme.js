// Colours and dashes of the curves: those of the figures (service/figures/style.py), with enough contrast on a page.

const SOLID = [1, 0];
const DOTTED = [2, 2.5];
const DASHED = [7, 3];

const STYLES = {
  cosine: ["#D55E00", SOLID],
  uniform: ["#000000", DOTTED],
  "ltc-nonnegative": ["#0072B2", DOTTED],
  ltc: ["#0072B2", SOLID],
  cltc: ["#009E73", DASHED],
  "cltc-mis": ["#009E73", SOLID],
};
const OTHERS = ["#CC79A7", "#E69F00", "#56B4E9", "#6A3D9A", "#8C6D31", "#7F7F7F"];

// Each colour of the figures as it is on a light and on a dark page: at least 3:1 against it.
const ON_PAGE = {
  "#D55E00": ["#D55E00", "#FF8F4A"],
  "#000000": ["#000000", "#F2F2F2"],
  "#0072B2": ["#0072B2", "#5BB8F0"],
  "#009E73": ["#009E73", "#3BCB9B"],
  "#CC79A7": ["#C0649A", "#E59CC4"],
  "#E69F00": ["#B37A00", "#F5BE4B"],
  "#56B4E9": ["#2E8BC0", "#8AD0F7"],
  "#6A3D9A": ["#6A3D9A", "#B694E0"],
  "#8C6D31": ["#8C6D31", "#C9A968"],
  "#7F7F7F": ["#7F7F7F", "#A8A8A8"],
};

const dark = matchMedia("(prefers-color-scheme: dark)");

/** Call when the page becomes dark or light. */
export const onThemeChange = (listener) => dark.addEventListener("change", listener);

/** {colour, dash} of each technique; one without a style of its own gets the next free colour. */
export function techniqueStyles(techniques) {
  const unknown = techniques.filter((name) => !(name in STYLES));
  const style = (name) => {
    if (name in STYLES) return STYLES[name];
    const index = unknown.indexOf(name);
    return [OTHERS[index % OTHERS.length], [SOLID, DASHED, DOTTED][Math.floor(index / OTHERS.length) % 3]];
  };
  return new Map(
    techniques.map((name) => {
      const [colour, dash] = style(name);
      return [name, { colour: ON_PAGE[colour][dark.matches ? 1 : 0], dash }];
    }),
  );
}

/** Colours of what a plot has beside its curves. */
export function ink() {
  return dark.matches
    ? { text: "#D8DEE3", faint: "#2E3A42", line: "#9AA7B0", reference: "#E6EBEE" }
    : { text: "#222222", faint: "#E4E4E4", line: "#6B7780", reference: "#444444" };
}

/** The Vega-Lite config of every plot. */
export function config() {
  const { text, faint, line } = ink();
  const font = "Liberation Sans, Arial, Helvetica, sans-serif";
  return {
    // Whoever does not see a plot hears its label and reads the table: not each of its lines.
    mark: { aria: false },
    background: null,
    font,
    padding: { left: 2, right: 8, top: 6, bottom: 2 },
    view: { stroke: line, strokeWidth: 0.8 },
    axis: {
      aria: false,
      labelColor: text,
      titleColor: text,
      tickColor: line,
      gridColor: faint,
      gridWidth: 0.7,
      domain: false,
      labelFontSize: 11,
      titleFontSize: 12,
      titleFontWeight: "normal",
      titlePadding: 8,
      tickSize: 4,
      labelFlush: false,
    },
    axisY: { minExtent: 40 },
  };
}
