#pragma once

namespace windhover {

/// The report's style sheet: follows the reader's light or dark theme, prints on white. Series
/// colours: M. Okabe and K. Ito, "Color Universal Design", 2008.
inline constexpr const char* kReportStyle = R"css(
:root { color-scheme: light dark; --ink: #1b2430; --soft: #5b6776; --paper: #ffffff;
  --panel: #f5f7fa; --rule: #d9dfe7; --pass: #00684d; --fail: #b3410a; --invalid: #6b4a86;
  --s0: #0072b2; --s1: #d55e00; --s2: #009e73; --s3: #aa4499; --s4: #b8860b; --s5: #3a8fc2; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6ebf2; --soft: #9aa7b8; --paper: #12161c;
  --panel: #1b2129; --rule: #333d4a; --pass: #1a8f6c; --fail: #d2601f; --invalid: #8f6bb0;
  --s0: #56b4e9; --s1: #ff8a3d; --s2: #2fc79a; --s3: #e39bc8; --s4: #f0c040; --s5: #9ad0f5; } }
@media print { :root { --ink: #000; --soft: #444; --paper: #fff; --panel: #fff; --rule: #bbb; }
  section, figure, tr { break-inside: avoid; } body { max-width: none !important; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1080px; padding: 28px 24px 60px; background: var(--paper);
  color: var(--ink); font: 15px/1.5 system-ui, "Segoe UI", "Helvetica Neue", "DejaVu Sans", sans-serif; }
header { border-radius: 10px; padding: 20px 26px; color: #fff; print-color-adjust: exact;
  -webkit-print-color-adjust: exact; }
header.pass { background: var(--pass); } header.fail { background: var(--fail); }
header.invalid { background: var(--invalid); }
header h1 { margin: 0; font-size: 26px; letter-spacing: .02em; }
header p { margin: 4px 0 0; opacity: .95; }
h2 { font-size: 18px; margin: 34px 0 10px; border-bottom: 1px solid var(--rule); padding-bottom: 4px; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 12px; margin-top: 16px; }
.tile { background: var(--panel); border: 1px solid var(--rule); border-radius: 8px; padding: 10px 14px; }
.tile b { display: block; font-size: 21px; font-variant-numeric: tabular-nums; }
.tile span { color: var(--soft); font-size: 13px; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 14px; font-variant-numeric: tabular-nums; }
th, td { padding: 6px 8px; border-bottom: 1px solid var(--rule); text-align: right; white-space: nowrap; }
th:first-child, td:first-child, td.text, th.text { text-align: left; }
td.text { white-space: normal; }
td.metric { text-align: left; }
th { color: var(--soft); font-weight: 600; font-size: 13px; }
td small { display: block; color: var(--soft); font-size: 11.5px; }
.badge { display: inline-block; border-radius: 4px; padding: 0 8px; color: #fff; font-weight: 600;
  print-color-adjust: exact; -webkit-print-color-adjust: exact; }
.badge.pass { background: var(--pass); } .badge.fail { background: var(--fail); }
.note { color: var(--soft); font-size: 13px; }
figure { margin: 14px 0; } figcaption { font-weight: 600; margin-bottom: 2px; }
svg.chart { width: 100%; height: auto; background: var(--panel); border: 1px solid var(--rule); border-radius: 8px; }
svg.chart text { fill: var(--soft); font-size: 12.5px; font-family: inherit; }
.grid { stroke: var(--rule); stroke-width: 1; }
.line { fill: none; stroke-width: 2; stroke: currentColor; }
.mark { fill: currentColor; stroke: currentColor; stroke-width: 1.4; }
.mark circle, .mark rect, .mark path { stroke: none; }
.s0 { color: var(--s0); } .s1 { color: var(--s1); } .s2 { color: var(--s2); }
.s3 { color: var(--s3); } .s4 { color: var(--s4); } .s5 { color: var(--s5); }
.line.s1 { stroke-dasharray: 7 4; } .line.s2 { stroke-dasharray: 2 4; }
.line.s3 { stroke-dasharray: 10 4 2 4; } .line.s4 { stroke-dasharray: 14 5; }
.truth { color: var(--ink); } .line.truth { stroke-width: 2.4; }
.frames { display: grid; grid-template-columns: repeat(auto-fit, minmax(320px, 1fr)); gap: 14px; }
.frames figure { margin: 0; } .frames figcaption { font-weight: 400; color: var(--soft); font-size: 13px; }
svg.frame { width: 100%; height: auto; border-radius: 6px; display: block; }
.truth-box { fill: none; stroke: #ffffff; stroke-width: 3; stroke-dasharray: 12 7; }
.no-picture { fill: #46505c; } .box-label { fill: #fff; font-size: 34px; }
.detected-box { fill: none; stroke: #e69f00; stroke-width: 4; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 4px 18px; margin: 0; }
dt { color: var(--soft); } dd { margin: 0; overflow-wrap: anywhere; }
details pre { background: var(--panel); border: 1px solid var(--rule); border-radius: 8px; padding: 12px; overflow-x: auto; font-size: 12.5px; }
)css";

}  // namespace windhover
