//! `SvgWalker`: visits the elements of a file in document order, and draws them.
use super::names::{ElementTag, Key};
use super::path;
use super::path_builder::{PathBuilder, PathError};
use super::shape::{ElementError, LengthReader, PercentBasis, truncated_path_message};
use super::style::{ElementStyle, InheritedStyle, StyleCascade, StyleProperty};
use super::stylesheet::{MOST_RULES, SelectorSubject, StyleSheet};
use super::transform::{PreserveAspectRatio, SvgTransform};
use super::xml::XmlTree;
use crate::drawing::{Drawing, DrawingElement};
use crate::grow::{push, push_large};
use crate::text::{grouped, show};
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use chordal::math::add_up;
use std::collections::BTreeMap;

/// The deepest nesting of elements, including those that `use` adds: each level takes some of the call stack.
const DEEPEST: usize = 400;
/// The segments and elements that `use` may copy, whatever the file's size. Chosen: 64 MiB, at about 320
/// bytes each.
const COPIES: u64 = 200_000;

/// The properties that children inherit.
#[derive(Clone, Copy)]
struct ParentContext {
    map: SvgTransform,
    inherited: InheritedStyle,
    viewport: Option<[f64; 2]>,
    depth: usize,
}

/// A traversal of a tree.
pub(super) struct SvgWalker<'w, 'a> {
    tree: &'w XmlTree<'a>,
    limits: &'w Limits,
    warnings: &'w mut Warnings,
    sheet: StyleSheet,
    ids: BTreeMap<String, u32>,
    /// The targets of `use` that are being drawn.
    using: Vec<usize>,
    copies_left: u64,
    drawing: Drawing,
}

/// The size that a `use` gives to its symbol, and the rounding of its unit conversions.
#[derive(Clone, Copy, Debug, Default)]
struct UseSize {
    size: [Option<f64>; 2],
    lost: f64,
}

impl<'w, 'a> SvgWalker<'w, 'a> {
    pub fn new(tree: &'w XmlTree<'a>, limits: &'w Limits, warnings: &'w mut Warnings) -> Self {
        let mut sheet = StyleSheet::default();
        for (node, text) in &tree.sheets {
            sheet.add(text);
            let unsupported = std::mem::take(&mut sheet.unsupported);
            warnings.count_many("unsupported-css", unsupported, || {
                let message =
                    "style rules with more than the name of an element, a class or an id were left out";
                (tree.place(*node as usize), message.to_owned())
            });
        }
        warnings.count_many("too-many-css-rules", sheet.dropped, || {
            (FileLocation::File, format!("style declarations beyond the limit of {MOST_RULES} were left out"))
        });
        let mut ids = BTreeMap::new();
        for node in 0..tree.len() {
            let Some((id, at)) = tree.get(node, Key::Id) else { continue };
            if ids.contains_key(id.as_ref()) {
                warnings.count("duplicate-id", || {
                    (
                        tree.place_of(at),
                        "ids that stand twice mean the first element that has them".to_owned(),
                    )
                });
            } else {
                ids.insert(id.into_owned(), node as u32);
            }
        }
        let copies_left = COPIES + tree.bytes() / 2;
        let drawing = Drawing { y_down: true, ..Drawing::default() };
        Self { tree, limits, warnings, sheet, ids, using: Vec::new(), copies_left, drawing }
    }

    /// Draws the file.
    pub fn run(mut self) -> Result<Drawing, ReadError> {
        let viewport = self.root()?;
        let (map, inherited) = (SvgTransform::identity(), InheritedStyle::default());
        let context = ParentContext { map, inherited, viewport, depth: 0 };
        let cascade = self.cascade(0, InheritedStyle::default());
        if self.is_visible(0, &cascade.own) {
            let context = self.transformed(0, ParentContext { inherited: cascade.inherited, ..context })?;
            if let Some(context) = context {
                self.children(0, &context)?;
            }
        }
        Ok(self.drawing)
    }

    /// Reads the root. Coordinates are those of its view box, which is not applied.
    fn root(&mut self) -> Result<Option<[f64; 2]>, ReadError> {
        let tree = self.tree;
        let mut sizes = [None; 2];
        for (size, key) in sizes.iter_mut().zip([Key::Width, Key::Height]) {
            let Some((text, start)) = tree.get(0, key) else { continue };
            match super::length::SvgLength::read(&text) {
                Ok(length) if length.value > 0.0 => *size = Some(length),
                _ if text.trim() == "auto" => {}
                _ => self.warnings.count("bad-attribute", || {
                    let message =
                        "attributes that cannot be read were taken as not given: the size of the picture";
                    (tree.place_of(start), message.to_owned())
                }),
            }
        }
        let pixels = sizes.map(|size| size.and_then(|size| size.resolve(None)));
        let port = pixels[0].zip(pixels[1]).map(|(w, h)| [w, h]);
        let view_box = self.view_box(0)?;
        let shown = view_box.or(port.map(|[w, h]| [0.0, 0.0, w, h]));
        self.drawing.view_box = shown;
        let metres = |k: usize| {
            let size = sizes[k]?;
            Some(size.unit.metres()? * size.value)
        };
        let aspect = self.aspect(0);
        self.drawing.frame.metres_per_unit = match (metres(0), metres(1), shown) {
            (Some(w), Some(h), Some([_, _, vw, vh])) => aspect.scale([vw, vh], [w, h]),
            // A missing size follows from the other one and the view box.
            (Some(w), None, Some([_, _, vw, _])) if sizes[1].is_none() => Some(w / vw),
            (None, Some(h), Some([_, _, _, vh])) if sizes[0].is_none() => Some(h / vh),
            _ => None,
        };
        Ok(shown.map(|[_, _, w, h]| [w, h]))
    }

    /// The view box of an element, if it has one with a size.
    fn view_box(&mut self, node: usize) -> Result<Option<[f64; 4]>, ReadError> {
        let tree = self.tree;
        let Some((text, start)) = tree.get(node, Key::ViewBox) else { return Ok(None) };
        let (all, trouble) = super::cursor::numbers(&text);
        if let Some(trouble) = trouble.as_ref().filter(|trouble| trouble.not_finite) {
            let place = tree.place_in(&text, start, trouble.at);
            return Err(ReadError::new("not-finite", place, trouble.what.clone()));
        }
        match (all.as_slice(), trouble) {
            ([x, y, w, h], None) if *w > 0.0 && *h > 0.0 => Ok(Some([*x, *y, *w, *h])),
            _ => {
                self.warnings.count("bad-attribute", || {
                    let message = "attributes that cannot be read were taken as not given: a view box is four \
                                   numbers, the last two greater than 0";
                    (tree.place_of(start), message.to_owned())
                });
                Ok(None)
            }
        }
    }

    fn aspect(&mut self, node: usize) -> PreserveAspectRatio {
        let tree = self.tree;
        let Some((text, start)) = tree.get(node, Key::Aspect) else { return PreserveAspectRatio::default() };
        PreserveAspectRatio::read(&text).unwrap_or_else(|| {
            self.warnings.count("bad-attribute", || {
                let message = "attributes that cannot be read were taken as not given: preserveAspectRatio";
                (tree.place_of(start), message.to_owned())
            });
            PreserveAspectRatio::default()
        })
    }

    /// The style of an element, from attributes, style sheets and its `style`, in this order.
    fn cascade(&mut self, node: usize, parent: InheritedStyle) -> StyleCascade {
        let tree = self.tree;
        let mut cascade = StyleCascade::from(parent);
        let mut style = None;
        for (key, value, _) in tree.attributes(node) {
            if let Some(property) = StyleProperty::from_attribute(key) {
                cascade.set(property, &value);
            } else if key == Key::Style {
                style = Some(value);
            }
        }
        if !self.sheet.is_empty() {
            let value = |key| tree.get(node, key).map(|found| found.0);
            let name = tree.name(node);
            let element = name.rsplit(':').next().unwrap_or(name);
            let named = SelectorSubject { element, id: value(Key::Id), class: value(Key::Class) };
            for (property, value) in self.sheet.matching(&named) {
                cascade.set(property, value);
            }
        }
        if let Some(style) = style {
            cascade.set_all(&style);
        }
        cascade
    }

    fn warn(&mut self, node: usize, code: &'static str, message: &str) {
        let tree = self.tree;
        self.warnings.count(code, || (tree.place(node), message.to_owned()));
    }

    /// Counts unsupported properties of an element. Returns whether it is drawn at all.
    fn is_visible(&mut self, node: usize, style: &ElementStyle) -> bool {
        if style.hidden {
            self.warn(node, "hidden", "elements that are not displayed were left out");
            return false;
        }
        let unsupported = [
            (style.clipped, "unsupported-clip-path", "clip paths are not applied: shapes are whole"),
            (style.masked, "unsupported-mask", "masks are not applied: shapes are whole"),
            (style.filtered, "unsupported-filter", "filters are not applied"),
            (
                style.css_geometry,
                "unsupported-css-geometry",
                "geometry and transforms are read from attributes, not from styles, and turn about the origin",
            ),
            (
                style.sheer,
                "unsupported-opacity",
                "opacity is not looked at: what shows through is drawn as if it did not",
            ),
            (style.important, "unsupported-important", "'!important' does not change which style wins"),
        ];
        for (_, code, message) in unsupported.into_iter().filter(|row| row.0) {
            self.warn(node, code, message);
        }
        true
    }

    fn children(&mut self, node: usize, context: &ParentContext) -> Result<(), ReadError> {
        let tree = self.tree;
        for child in tree.children(node) {
            self.element(child, context)?;
        }
        Ok(())
    }

    fn element(&mut self, node: usize, context: &ParentContext) -> Result<(), ReadError> {
        let tree = self.tree;
        let tag = tree.tag(node);
        if !self.conditions_hold(node) {
            self.warn(
                node,
                "conditional-element",
                "elements for other languages, or that ask for extensions, were left out",
            );
            return Ok(());
        }
        match tag {
            ElementTag::Silent | ElementTag::Style | ElementTag::Symbol => return Ok(()),
            ElementTag::Foreign => {
                self.warn(node, "foreign-element", "elements of other namespaces were left out");
                return Ok(());
            }
            ElementTag::Unknown => {
                let name = show(tree.name(node).as_bytes());
                self.warn(
                    node,
                    "unknown-element",
                    &format!("elements that SVG does not have were left out, {name} first"),
                );
                return Ok(());
            }
            ElementTag::Unsupported(what) => {
                let (code, message) = what.warning();
                self.warn(node, code, message);
                return Ok(());
            }
            _ => {}
        }
        if context.depth >= DEEPEST {
            let message = format!("nested deeper than the limit of {DEEPEST} levels, with what 'use' brings");
            return Err(ReadError::new("too-deep", tree.place(node), message));
        }
        self.count_copies(node, 1)?;
        let cascade = self.cascade(node, context.inherited);
        if !self.is_visible(node, &cascade.own) {
            return Ok(());
        }
        let inner = ParentContext { inherited: cascade.inherited, depth: context.depth + 1, ..*context };
        let Some(inner) = self.transformed(node, inner)? else { return Ok(()) };
        match tag {
            ElementTag::Svg => self.viewport(node, &inner, UseSize::default()),
            ElementTag::Use => self.used(node, &inner),
            ElementTag::Switch => self.switch(node, &inner),
            tag if tag.is_shape() => self.shape(node, &inner),
            _ => self.children(node, &inner),
        }
    }

    /// The context with the element's transform; `None` if nothing can be drawn with it.
    fn transformed(
        &mut self,
        node: usize,
        context: ParentContext,
    ) -> Result<Option<ParentContext>, ReadError> {
        let tree = self.tree;
        let Some((text, start)) = tree.get(node, Key::Transform) else { return Ok(Some(context)) };
        let map = match SvgTransform::read(&text) {
            Ok(map) => map,
            Err(trouble) => {
                let place = tree.place_in(&text, start, trouble.at);
                if trouble.not_finite && !self.limits.drop_nonfinite {
                    return Err(ReadError::new("not-finite", place, trouble.what));
                }
                self.warnings.count("bad-transform", || {
                    (place, format!("transforms that cannot be read were left out: {}", trouble.what))
                });
                return Ok(Some(context));
            }
        };
        if map.is_singular() {
            self.warn(node, "singular-transform", "elements whose transform leaves no area are not drawn");
            return Ok(None);
        }
        Ok(Some(ParentContext { map: context.map.after(&map), ..context }))
    }

    /// Draws a nested picture, or the symbol of a `use` with the size that the `use` gives.
    fn viewport(&mut self, node: usize, context: &ParentContext, given: UseSize) -> Result<(), ReadError> {
        let place = match self.port(node, context) {
            Ok(place) => place,
            Err(ElementError::Skip) => return Ok(()),
            Err(ElementError::Refuse(error)) => return Err(error),
        };
        let ([x, y, w, h], lost) = place;
        let size = [given.size[0].or(w), given.size[1].or(h)];
        let lost = if given.lost > 0.0 { add_up(lost, given.lost) } else { lost };
        let outer = context.viewport;
        let size = [0, 1].map(|k| size[k].or(outer.map(|size| size[k])));
        let view_box = self.view_box(node)?;
        let aspect = self.aspect(node);
        let at = [x.unwrap_or(0.0), y.unwrap_or(0.0)];
        let (map, inner_port) = match (view_box, size) {
            (Some(_), [Some(w), Some(h)]) if w <= 0.0 || h <= 0.0 => return Ok(()),
            (Some(view), [Some(w), Some(h)]) => {
                (SvgTransform::fit(view, [at[0], at[1], w, h], aspect), Some([view[2], view[3]]))
            }
            (Some(view), _) => {
                self.warn(
                    node,
                    "unknown-viewport",
                    "view boxes inside pictures of no known size are not applied",
                );
                (SvgTransform::translation(at), Some([view[2], view[3]]))
            }
            (None, [Some(w), Some(h)]) => (SvgTransform::translation(at), Some([w, h])),
            (None, _) => (SvgTransform::translation(at), outer),
        };
        self.warn(
            node,
            "unsupported-viewport-clip",
            "what stands outside an inner picture or symbol is not cut off",
        );
        let map = map.with_error(lost, view_box);
        let inner = ParentContext { map: context.map.after(&map), viewport: inner_port, ..*context };
        self.children(node, &inner)
    }

    /// The position and size of an element, and the rounding of their unit conversions.
    fn port(
        &mut self,
        node: usize,
        context: &ParentContext,
    ) -> Result<([Option<f64>; 4], f64), ElementError> {
        let mut numbers = self.numbers(node, context);
        let port = [
            numbers.length(Key::X, PercentBasis::X)?,
            numbers.length(Key::Y, PercentBasis::Y)?,
            numbers.length(Key::Width, PercentBasis::X)?,
            numbers.length(Key::Height, PercentBasis::Y)?,
        ];
        Ok((port, numbers.lost))
    }

    fn numbers(&mut self, node: usize, context: &ParentContext) -> LengthReader<'_, 'a> {
        LengthReader {
            tree: self.tree,
            node,
            viewport: context.viewport,
            limits: self.limits,
            warnings: self.warnings,
            lost: 0.0,
        }
    }

    /// Whether the conditions of an element hold, for an English-speaking reader without extensions.
    fn conditions_hold(&self, node: usize) -> bool {
        let language = self.tree.get(node, Key::SystemLanguage).is_none_or(|(all, _)| {
            all.split(',').any(|one| one.trim() == "en" || one.trim().starts_with("en-"))
        });
        language && self.tree.get(node, Key::RequiredExtensions).is_none()
    }

    /// Draws the first child whose conditions hold.
    fn switch(&mut self, node: usize, context: &ParentContext) -> Result<(), ReadError> {
        let tree = self.tree;
        let holds = |child: &usize| {
            self.conditions_hold(*child)
                && !matches!(tree.tag(*child), ElementTag::Foreign | ElementTag::Unknown | ElementTag::Silent)
        };
        match tree.children(node).find(holds) {
            Some(child) => self.element(child, context),
            None => Ok(()),
        }
    }

    fn used(&mut self, node: usize, context: &ParentContext) -> Result<(), ReadError> {
        let tree = self.tree;
        let href = tree.get(node, Key::Href).or_else(|| tree.get(node, Key::XlinkHref));
        let Some((href, at)) = href else {
            self.warn(node, "missing-target", "'use' elements that name nothing in this file were left out");
            return Ok(());
        };
        let Some(id) = href.trim().strip_prefix('#') else {
            self.warn(
                node,
                "external-use",
                "'use' elements that name another file were left out: nothing is fetched",
            );
            return Ok(());
        };
        let Some(target) = self.ids.get(id).map(|target| *target as usize) else {
            self.warn(node, "missing-target", "'use' elements that name nothing in this file were left out");
            return Ok(());
        };
        let holds_itself = target <= node && node < tree.end(target);
        if holds_itself || self.using.contains(&target) {
            let message = format!("'use' of {} leads back to itself", show(id.as_bytes()));
            return Err(ReadError::new("use-cycle", tree.place_of(at), message));
        }
        let ([x, y, w, h], lost) = match self.port(node, context) {
            Ok(port) => port,
            Err(ElementError::Skip) => return Ok(()),
            Err(ElementError::Refuse(error)) => return Err(error),
        };
        let by = SvgTransform::translation([x.unwrap_or(0.0), y.unwrap_or(0.0)]).with_error(lost, None);
        let inner = ParentContext { map: context.map.after(&by), ..*context };
        self.using.push(target);
        let drawn = match tree.tag(target) {
            ElementTag::Symbol | ElementTag::Svg => {
                self.draw_instance(target, &inner, UseSize { size: [w, h], lost })
            }
            _ => self.element(target, &inner),
        };
        self.using.pop();
        drawn
    }

    /// Draws the symbol or picture of a `use`.
    fn draw_instance(
        &mut self,
        node: usize,
        context: &ParentContext,
        given: UseSize,
    ) -> Result<(), ReadError> {
        self.count_copies(node, 1)?;
        let cascade = self.cascade(node, context.inherited);
        if !self.is_visible(node, &cascade.own) {
            return Ok(());
        }
        let inner = ParentContext { inherited: cascade.inherited, depth: context.depth + 1, ..*context };
        match self.transformed(node, inner)? {
            Some(inner) => self.viewport(node, &inner, given),
            None => Ok(()),
        }
    }

    /// Counts elements drawn by `use` against a separate limit: a few lines can expand beyond all memory.
    fn count_copies(&mut self, node: usize, more: u64) -> Result<(), ReadError> {
        if self.using.is_empty() {
            return Ok(());
        }
        let left = self.copies_left.checked_sub(more);
        self.copies_left = left.ok_or_else(|| {
            let most = grouped(COPIES + self.tree.bytes() / 2);
            let message =
                format!("'use' elements copy more than the limit of {most} elements and pieces here");
            ReadError::new("too-many-copies", self.tree.place(node), message)
        })?;
        Ok(())
    }

    fn shape(&mut self, node: usize, context: &ParentContext) -> Result<(), ReadError> {
        if !context.inherited.visible {
            self.warn(node, "hidden", "elements that are not displayed were left out");
            return Ok(());
        }
        let mut pen = PathBuilder::default();
        match self.draw_shape(node, context, &mut pen) {
            Ok(()) => {}
            Err(ElementError::Skip) => return Ok(()),
            Err(ElementError::Refuse(error)) => return Err(error),
        }
        let tree = self.tree;
        self.warnings.count_many("lone-point", pen.lone_points, || {
            (tree.place(node), "subpaths that only move and draw nothing were left out".to_owned())
        });
        if pen.curves.is_empty() {
            return Ok(());
        }
        let looks = context.inherited;
        let unsupported = [
            (
                looks.stroked,
                "unsupported-stroke",
                "strokes are not outlined: the line in their middle is drawn",
            ),
            (looks.marked, "unsupported-marker", "markers are not drawn"),
            (
                looks.filled && looks.painted,
                "unsupported-paint",
                "gradients and patterns are plain fills here",
            ),
        ];
        for (_, code, message) in unsupported.into_iter().filter(|row| row.0) {
            self.warn(node, code, message);
        }
        self.add_element(node, context, pen)
    }

    fn draw_shape(
        &mut self,
        node: usize,
        context: &ParentContext,
        pen: &mut PathBuilder,
    ) -> Result<(), ElementError> {
        let tree = self.tree;
        let tag = tree.tag(node);
        let mut numbers = self.numbers(node, context);
        if tag != ElementTag::Path {
            return numbers.draw(tag, pen);
        }
        let Some((text, start)) = tree.get(node, Key::D) else { return Err(ElementError::Skip) };
        if text.trim() == "none" {
            return Err(ElementError::Skip);
        }
        match path::draw(&text, pen) {
            Ok(()) => Ok(()),
            Err(PathError::Read(error)) => Err(error.into()),
            Err(PathError::Text(trouble)) => {
                let place = tree.place_in(&text, start, trouble.at);
                if trouble.not_finite {
                    return Err(numbers.not_finite(place, trouble.what));
                }
                numbers.warnings.count("path-error", || (place, truncated_path_message(&trouble.what)));
                Ok(())
            }
        }
    }

    /// Adds the finished paths to the drawing.
    fn add_element(
        &mut self,
        node: usize,
        context: &ParentContext,
        pen: PathBuilder,
    ) -> Result<(), ReadError> {
        let tree = self.tree;
        let pieces: u64 = pen.curves.iter().map(|curve| curve.segments().len() as u64).sum();
        self.count_copies(node, pieces)?;
        let owner = self.drawing.elements.len() as u32;
        let first = self.drawing.lines.len();
        for curve in pen.curves {
            let curve = if context.map.is_identity() {
                curve
            } else {
                match context.map.apply(&curve) {
                    Ok(curve) => curve,
                    Err(_) => {
                        let what = "a transform takes a coordinate over the limit of 1.8e308".to_owned();
                        self.drawing.lines.truncate(first);
                        self.drawing.owners.truncate(first);
                        let place = tree.place(node);
                        return match self.numbers(node, context).not_finite(place, what) {
                            ElementError::Skip => Ok(()),
                            ElementError::Refuse(error) => Err(error),
                        };
                    }
                }
            };
            push_large(&mut self.drawing.lines, curve)?;
            push(&mut self.drawing.owners, owner)?;
        }
        let name = tree.get(node, Key::Id).map_or_else(Box::default, |found| Box::from(&*found.0));
        let InheritedStyle { filled, rule, .. } = context.inherited;
        let tag = tree.tag(node);
        let element = DrawingElement {
            kind: tag.kind(),
            name,
            source: u64::from(owner),
            rule,
            // A line has no interior.
            filled: filled && tag != ElementTag::Line,
        };
        push_large(&mut self.drawing.elements, element)
    }
}
