//! `StyleCascade`: the style properties that decide what is drawn: fill, fill rule, visibility.
use super::names::Key;
use chordal::explicit::FillRule;

/// The properties that children inherit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct InheritedStyle {
    pub filled: bool,
    pub rule: FillRule,
    pub visible: bool,
    pub stroked: bool,
    pub marked: bool,
    /// Filled with something other than a colour.
    pub painted: bool,
}

impl Default for InheritedStyle {
    fn default() -> Self {
        Self {
            filled: true,
            rule: FillRule::NonZero,
            visible: true,
            stroked: false,
            marked: false,
            painted: false,
        }
    }
}

/// The properties that children do not inherit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ElementStyle {
    pub hidden: bool,
    pub clipped: bool,
    pub masked: bool,
    pub filtered: bool,
    /// Geometry, a transform or its origin given in CSS, which is not supported.
    pub css_geometry: bool,
    /// An opacity below 1, which is ignored.
    pub sheer: bool,
    pub important: bool,
}

/// A known property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StyleProperty {
    Fill,
    FillRule,
    Display,
    Visibility,
    Stroke,
    ClipPath,
    Mask,
    Filter,
    Marker,
    /// Geometry, which is only read from attributes.
    Geometry,
    Opacity,
}

impl StyleProperty {
    /// Converts from its name in a style sheet.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "fill" => Self::Fill,
            "fill-rule" => Self::FillRule,
            "display" => Self::Display,
            "visibility" => Self::Visibility,
            "stroke" => Self::Stroke,
            "clip-path" => Self::ClipPath,
            "mask" => Self::Mask,
            "filter" => Self::Filter,
            "opacity" | "fill-opacity" => Self::Opacity,
            "marker" | "marker-start" | "marker-mid" | "marker-end" => Self::Marker,
            "transform-origin" | "transform-box" | "d" | "x" | "y" | "cx" | "cy" | "r" | "rx" | "ry"
            | "width" | "height" | "transform" | "rotate" | "scale" | "translate" | "offset-path" => {
                Self::Geometry
            }
            _ => return None,
        })
    }

    /// Converts from the attribute with the same meaning.
    pub fn from_attribute(key: Key) -> Option<Self> {
        Some(match key {
            Key::Fill => Self::Fill,
            Key::FillRule => Self::FillRule,
            Key::Display => Self::Display,
            Key::Visibility => Self::Visibility,
            Key::Stroke => Self::Stroke,
            Key::ClipPath => Self::ClipPath,
            Key::Mask => Self::Mask,
            Key::Filter => Self::Filter,
            Key::TransformOrigin => Self::Geometry,
            Key::Opacity | Key::FillOpacity => Self::Opacity,
            Key::Marker | Key::MarkerStart | Key::MarkerMid | Key::MarkerEnd => Self::Marker,
            _ => return None,
        })
    }
}

/// The style of one element, while it is derived from that of its parent.
#[derive(Clone, Copy, Debug)]
pub(super) struct StyleCascade {
    pub inherited: InheritedStyle,
    pub own: ElementStyle,
    parent: InheritedStyle,
}

impl StyleCascade {
    pub fn from(parent: InheritedStyle) -> Self {
        Self { inherited: parent, own: ElementStyle::default(), parent }
    }

    /// Applies one declaration; later ones win.
    pub fn set(&mut self, property: StyleProperty, value: &str) {
        let value = value.trim();
        let (value, important) = match value.rsplit_once('!') {
            Some((before, word)) if word.trim().eq_ignore_ascii_case("important") => (before.trim(), true),
            _ => (value, false),
        };
        self.own.important |= important;
        let is = |word: &str| value.eq_ignore_ascii_case(word);
        let (looks, own) = (&mut self.inherited, &mut self.own);
        let inherits = is("inherit") || is("unset");
        let initial = InheritedStyle::default();
        match property {
            StyleProperty::Fill => {
                let explicit = (!is("none") && !is("transparent"), value.contains("url("));
                (looks.filled, looks.painted) = match value {
                    _ if inherits => (self.parent.filled, self.parent.painted),
                    _ if is("initial") => (initial.filled, initial.painted),
                    _ => explicit,
                };
            }
            StyleProperty::FillRule if inherits => looks.rule = self.parent.rule,
            StyleProperty::FillRule if is("evenodd") => looks.rule = FillRule::EvenOdd,
            StyleProperty::FillRule if is("nonzero") || is("initial") => looks.rule = FillRule::NonZero,
            StyleProperty::Visibility if inherits => looks.visible = self.parent.visible,
            StyleProperty::Visibility if is("hidden") || is("collapse") => looks.visible = false,
            StyleProperty::Visibility if is("visible") || is("initial") => looks.visible = true,
            StyleProperty::FillRule | StyleProperty::Visibility => {}
            StyleProperty::Stroke if inherits => looks.stroked = self.parent.stroked,
            StyleProperty::Stroke => looks.stroked = !is("none") && !is("initial") && !is("transparent"),
            StyleProperty::Marker if inherits => looks.marked = self.parent.marked,
            StyleProperty::Marker => looks.marked = !is("none") && !is("initial"),
            StyleProperty::Display => own.hidden = is("none"),
            StyleProperty::ClipPath => own.clipped = !is("none"),
            StyleProperty::Mask => own.masked = !is("none"),
            StyleProperty::Filter => own.filtered = !is("none"),
            StyleProperty::Geometry => own.css_geometry = true,
            StyleProperty::Opacity => {
                own.sheer = !(is("1") || is("1.0") || is("100%") || inherits || is("initial"))
            }
        }
    }

    /// Applies the declarations of a `style` attribute.
    pub fn set_all(&mut self, text: &str) {
        for (name, value) in declarations(text) {
            if let Some(property) = StyleProperty::from_name(&name.to_ascii_lowercase()) {
                self.set(property, value);
            }
        }
    }
}

/// Splits `name: value` pairs at semicolons.
pub(super) fn declarations(text: &str) -> impl Iterator<Item = (&str, &str)> {
    text.split(';').filter_map(|one| one.split_once(':')).map(|(name, value)| (name.trim(), value.trim()))
}
