//! `ModelNamespace`: the namespaces of 3MF and of its extensions.
use crate::xml_elements::{NamespaceKind, XmlElements};
use crate::xml_text::CERTIFICATE_NAMESPACE;

/// The namespace of the core.
pub(super) const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
/// The namespace of the materials extension.
pub(super) const MATERIALS: &str = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";
/// The namespace of relationships of a package.
pub(super) const RELATIONSHIPS: &str = "http://schemas.openxmlformats.org/package/2006/relationships";

/// The elements of a model part.
pub(super) type ModelElements<'a> = XmlElements<'a, ModelNamespace>;

/// The meaning of a namespace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ModelNamespace {
    /// No namespace, as most attributes have.
    None,
    Core,
    Materials,
    Production,
    BeamLattice,
    Slice,
    TriangleSets,
    Boolean,
    Displacement,
    Volumetric,
    SecureContent,
    Relationships,
    /// This library's namespace, for the certificate.
    Certificate,
    Unknown,
}

/// The namespaces by the beginning of their name, which is the same in all versions.
const BY_START: [(&str, ModelNamespace); 10] = [
    ("http://schemas.microsoft.com/3dmanufacturing/production/", ModelNamespace::Production),
    ("http://schemas.microsoft.com/3dmanufacturing/beamlattice/", ModelNamespace::BeamLattice),
    ("http://schemas.microsoft.com/3dmanufacturing/slice/", ModelNamespace::Slice),
    ("http://schemas.microsoft.com/3dmanufacturing/trianglesets/", ModelNamespace::TriangleSets),
    ("http://schemas.microsoft.com/3dmanufacturing/securecontent/", ModelNamespace::SecureContent),
    ("http://schemas.3mf.io/3dmanufacturing/booleanoperations/", ModelNamespace::Boolean),
    ("http://schemas.3mf.io/3dmanufacturing/displacement/", ModelNamespace::Displacement),
    ("http://schemas.microsoft.com/3dmanufacturing/displacement/", ModelNamespace::Displacement),
    ("http://schemas.3mf.io/3dmanufacturing/volumetric/", ModelNamespace::Volumetric),
    ("http://schemas.3mf.io/3dmanufacturing/implicit/", ModelNamespace::Volumetric),
];

impl NamespaceKind for ModelNamespace {
    const NONE: Self = Self::None;
    const UNKNOWN: Self = Self::Unknown;
    fn from_address(address: &str) -> Self {
        match address {
            "" => Self::None,
            CORE => Self::Core,
            MATERIALS => Self::Materials,
            RELATIONSHIPS => Self::Relationships,
            CERTIFICATE_NAMESPACE => Self::Certificate,
            other => BY_START
                .iter()
                .find(|(start, _)| other.starts_with(start))
                .map_or(Self::Unknown, |(_, namespace)| *namespace),
        }
    }
}

impl ModelNamespace {
    /// Its name, for messages.
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::None | Self::Unknown => "unknown",
            Self::Core => "core",
            Self::Materials => "materials",
            Self::Production => "production",
            Self::BeamLattice => "beam lattice",
            Self::Slice => "slice",
            Self::TriangleSets => "triangle sets",
            Self::Boolean => "boolean operations",
            Self::Displacement => "displacement",
            Self::Volumetric => "volumetric",
            Self::SecureContent => "secure content",
            Self::Relationships => "relationships",
            Self::Certificate => "certificate",
        }
    }

    /// Whether a file that requires the extension still has correct triangles here, or skipped elements are
    /// counted where they occur.
    pub(super) fn is_read(self) -> bool {
        matches!(
            self,
            Self::Core
                | Self::Materials
                | Self::Production
                | Self::BeamLattice
                | Self::Slice
                | Self::TriangleSets
                | Self::Certificate
        )
    }
}
