//! The known names: elements and attributes of SVG.

/// An element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ElementTag {
    Svg,
    Group,
    Switch,
    Use,
    Symbol,
    Path,
    Rect,
    Circle,
    Ellipse,
    Line,
    Polyline,
    Polygon,
    Style,
    /// A description, or a container whose content is drawn only by reference.
    Silent,
    /// Visible or with a visible effect, but not supported.
    Unsupported(UnsupportedFeature),
    /// Outside SVG's namespace.
    Foreign,
    /// In SVG's namespace, but unknown.
    Unknown,
}

/// An unsupported feature, by the code of its warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum UnsupportedFeature {
    Text,
    Image,
    ForeignObject,
    Animation,
    Script,
    Media,
}

impl ElementTag {
    /// The element of SVG's namespace with this name.
    pub fn from_name(name: &str) -> Self {
        match name {
            "svg" => Self::Svg,
            "g" | "a" => Self::Group,
            "switch" => Self::Switch,
            "use" => Self::Use,
            "symbol" => Self::Symbol,
            "path" => Self::Path,
            "rect" => Self::Rect,
            "circle" => Self::Circle,
            "ellipse" => Self::Ellipse,
            "line" => Self::Line,
            "polyline" => Self::Polyline,
            "polygon" => Self::Polygon,
            "style" => Self::Style,
            "defs" | "clipPath" | "mask" | "pattern" | "marker" | "linearGradient" | "radialGradient"
            | "meshgradient" | "hatch" | "solidcolor" | "filter" | "stop" | "title" | "desc" | "metadata"
            | "view" | "cursor" | "font" | "font-face" | "glyph" | "missing-glyph" | "color-profile" => {
                Self::Silent
            }
            "text" | "tspan" | "textPath" | "tref" | "altGlyph" => {
                Self::Unsupported(UnsupportedFeature::Text)
            }
            "image" => Self::Unsupported(UnsupportedFeature::Image),
            "foreignObject" => Self::Unsupported(UnsupportedFeature::ForeignObject),
            "animate" | "animateMotion" | "animateTransform" | "animateColor" | "set" | "discard"
            | "mpath" => Self::Unsupported(UnsupportedFeature::Animation),
            "script" | "handler" | "listener" => Self::Unsupported(UnsupportedFeature::Script),
            "video" | "audio" | "iframe" | "canvas" => Self::Unsupported(UnsupportedFeature::Media),
            // Light sources and filter primitives.
            _ if name.starts_with("fe") => Self::Silent,
            _ => Self::Unknown,
        }
    }

    /// Whether it is drawn as a path.
    pub fn is_shape(self) -> bool {
        matches!(
            self,
            Self::Path
                | Self::Rect
                | Self::Circle
                | Self::Ellipse
                | Self::Line
                | Self::Polyline
                | Self::Polygon
        )
    }

    /// The name of a shape.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Rect => "rect",
            Self::Circle => "circle",
            Self::Ellipse => "ellipse",
            Self::Line => "line",
            Self::Polyline => "polyline",
            Self::Polygon => "polygon",
            _ => "path",
        }
    }
}

impl UnsupportedFeature {
    /// The code and the message of the warning.
    pub fn warning(self) -> (&'static str, &'static str) {
        match self {
            Self::Text => {
                ("unsupported-text", "text is not drawn: turn it to paths in the program that made it")
            }
            Self::Image => ("unsupported-image", "pictures are not drawn, and nothing is fetched"),
            Self::ForeignObject => ("unsupported-foreign-object", "foreign objects are not drawn"),
            Self::Animation => {
                ("unsupported-animation", "animations are not run: shapes are as they stand in the file")
            }
            Self::Script => ("ignored-script", "scripts are ignored: nothing in a file ever runs"),
            Self::Media => ("unsupported-media", "media and embedded pages are not drawn"),
        }
    }
}

macro_rules! keys {
    ($($name:literal $key:ident,)*) => {
        /// A known attribute.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Key {
            $($key,)*
        }

        impl Key {
            /// The attribute with this name.
            pub fn from_name(name: &str) -> Option<Self> {
                match name {
                    $($name => Some(Self::$key),)*
                    _ => None,
                }
            }
        }
    };
}

keys! {
    "d" D,
    "points" Points,
    "x" X,
    "y" Y,
    "x1" X1,
    "y1" Y1,
    "x2" X2,
    "y2" Y2,
    "cx" Cx,
    "cy" Cy,
    "r" R,
    "rx" Rx,
    "ry" Ry,
    "width" Width,
    "height" Height,
    "viewBox" ViewBox,
    "preserveAspectRatio" Aspect,
    "transform" Transform,
    "href" Href,
    "xlink:href" XlinkHref,
    "id" Id,
    "class" Class,
    "style" Style,
    "fill" Fill,
    "fill-rule" FillRule,
    "display" Display,
    "visibility" Visibility,
    "stroke" Stroke,
    "clip-path" ClipPath,
    "mask" Mask,
    "filter" Filter,
    "marker" Marker,
    "marker-start" MarkerStart,
    "marker-mid" MarkerMid,
    "marker-end" MarkerEnd,
    "transform-origin" TransformOrigin,
    "opacity" Opacity,
    "fill-opacity" FillOpacity,
    "systemLanguage" SystemLanguage,
    "requiredExtensions" RequiredExtensions,
    "media" Media,
    "type" Type,
}
