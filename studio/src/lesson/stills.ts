// Stills of many shapes as files of their own, which a browser loads when they come near: in the page they would weigh more than
// all its text. Each carries the style rules that it uses.
import { createHash } from "node:crypto";
import { gzipSync } from "node:zlib";
import base from "../style/base.css?raw";
import fields from "../exhibits/fields.css?raw";
import figures from "../exhibits/figures.css?raw";
import hands from "../exhibits/hands.css?raw";
import handsOfFields from "../exhibits/hands_fields.css?raw";
import stage from "../exhibits/stage.css?raw";

/** Compressed bytes from which a still is a file. Chosen: a page of forty figures stays below 150 kB. */
const HEAVY = 3500;

export interface StillFile {
  file: string;
  bytes: Uint8Array;
}

/** Replaces heavy stills in a figure's HTML by images, and returns the files of those. */
export function lighter(html: string): { html: string; files: StillFile[] } {
  const files: StillFile[] = [];
  const replaced = html.replace(/<svg([^>]*) data-figure[^>]*>.*?<\/svg>/gs, (svg) => {
    if (gzipSync(svg).length < HEAVY) return svg;
    const [, viewBox, width, height] = /viewBox="(0 0 (\d+) (\d+))"/.exec(svg)!;
    const content = svg.slice(svg.indexOf(">") + 1, -"</svg>".length);
    const classes = new Set([...svg.matchAll(/class="([^"]*)"/g)].flatMap(([, names]) => names!.split(" ")));
    const style = [base, stage, figures, fields, hands, handsOfFields].map((css) => rules(css, classes)).join("");
    const whole = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="${viewBox}"><style>${style}</style><g class="scene flat">${content}</g></svg>`;
    const bytes = new TextEncoder().encode(whole);
    const file = `assets/still-${createHash("sha256").update(bytes).digest("hex").slice(0, 8)}.svg`;
    files.push({ file, bytes });
    const kind = /class="([^"]*)"/.exec(svg.slice(0, svg.indexOf(">")))?.[1] ?? "";
    return `<img class="still ${kind}" src="${file}" alt="" loading="lazy" width="${width}" height="${height}"/>`;
  });
  return { html: replaced, files };
}

/** The custom properties of a style sheet, and its rules for some classes. */
function rules(css: string, classes: ReadonlySet<string>): string {
  const found: string[] = [];
  const plain = css.replace(/\/\*.*?\*\//gs, "").replace(/@import[^;]*;/g, "");
  // A rule, or a media query of rules.
  for (const [, head, body] of plain.matchAll(/([^{}]+)\{((?:[^{}]|\{[^{}]*\})*)\}/g)) {
    const selector = head!.trim();
    if (selector.startsWith("@media")) {
      if (!/prefers-color-scheme/.test(selector)) continue;
      found.push(`${selector}{${body}}`);
    } else if (/^:root/.test(selector) || selector.split(",").some((part) => isFor(part, classes))) found.push(`${selector}{${body}}`);
  }
  return found.join("").replace(/\s+/g, " ");
}

/** Whether a selector names only classes of the still. */
function isFor(selector: string, classes: ReadonlySet<string>): boolean {
  const names = [...selector.matchAll(/\.([\w-]+)/g)].map(([, name]) => name!);
  return names.length > 0 && !/:(hover|active|focus)/.test(selector) && names.every((name) => classes.has(name) || name === "scene" || name === "flat") && names.some((name) => classes.has(name));
}
