#pragma once

namespace windhover {

/// The plot of a sweep's report whose axes the reader chooses. Reads the JSON in #sweep-data:
/// {"factors": [key], "metrics": [path], "points": [[value]], "means": [[[mean, low, high]]]}.
inline constexpr const char* kExplorer = R"html(
<p><label>metric <select id="ex-metric"></select></label>
<label>over <select id="ex-x"></select></label>
<label>colour <select id="ex-colour"></select></label></p>
<svg class="chart" id="ex-plot" viewBox="0 0 860 380" role="img"></svg>
<script>
(() => {
  const data = JSON.parse(document.getElementById('sweep-data').textContent);
  const select = id => document.getElementById(id);
  const fill = (id, names) => names.forEach((name, i) => select(id).add(new Option(name, i)));
  fill('ex-metric', data.metrics); fill('ex-x', data.factors); fill('ex-colour', data.factors);
  select('ex-x').value = data.factors.length - 1;
  const levelsOf = f => [...new Set(data.points.map(p => p[f]))];
  const isNumber = f => levelsOf(f).every(v => v !== '' && isFinite(v));
  const node = (name, attributes, text) => {
    const made = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const key in attributes) made.setAttribute(key, attributes[key]);
    if (text !== undefined) made.textContent = text;
    return made;
  };
  const hue = (value, levels) => `hsl(${(250 - 210 * levels.indexOf(value) /
      Math.max(levels.length - 1, 1) + 360) % 360} 65% 48%)`;
  function draw() {
    const plot = select('ex-plot'), m = +select('ex-metric').value, f = +select('ex-x').value,
          c = +select('ex-colour').value, levels = levelsOf(c);
    plot.replaceChildren();
    const shown = data.points.map((p, i) => ({p, v: data.means[i][m]})).filter(e => e.v[0] !== null);
    if (!shown.length) return;
    const names = levelsOf(f), number = isNumber(f);
    const xs = shown.map(e => number ? +e.p[f] : names.indexOf(e.p[f]));
    const range = values => { const lo = Math.min(...values), hi = Math.max(...values);
      const pad = (hi - lo || 1) * 0.04; return [lo - pad, hi + pad]; };
    const [x0, x1] = range(xs), [y0, y1] = range(shown.flatMap(e => e.v.filter(v => v !== null)));
    const X = x => 70 + (x - x0) / (x1 - x0) * 770, Y = y => 330 - (y - y0) / (y1 - y0) * 310;
    for (let k = 0; k <= 5; ++k) {
      const y = y0 + k / 5 * (y1 - y0), x = x0 + k / 5 * (x1 - x0);
      plot.append(node('line', {class: 'grid', x1: 70, x2: 840, y1: Y(y), y2: Y(y)}));
      plot.append(node('text', {x: 62, y: Y(y) + 4, 'text-anchor': 'end'}, y.toPrecision(3)));
      if (number) plot.append(node('text', {x: X(x), y: 348, 'text-anchor': 'middle'}, x.toPrecision(3)));
    }
    if (!number) names.forEach((name, i) =>
      plot.append(node('text', {x: X(i), y: 348, 'text-anchor': 'middle'}, name)));
    plot.append(node('text', {x: 455, y: 372, 'text-anchor': 'middle'}, data.factors[f]));
    shown.forEach((e, i) => {
      const colour = hue(e.p[c], levels), mark = node('g', {fill: colour, stroke: colour});
      if (e.v[1] !== null) mark.append(node('line', {x1: X(xs[i]), x2: X(xs[i]), y1: Y(e.v[1]), y2: Y(e.v[2])}));
      mark.append(node('circle', {cx: X(xs[i]), cy: Y(e.v[0]), r: 3.2}));
      mark.append(node('title', {}, data.factors.map((key, k) => `${key} = ${e.p[k]}`).join('\n') +
        `\n${data.metrics[m]} = ${e.v[0].toPrecision(4)}`));
      plot.append(mark);
    });
  }
  for (const id of ['ex-metric', 'ex-x', 'ex-colour']) select(id).onchange = draw;
  draw();
})();
</script>
)html";

}  // namespace windhover
