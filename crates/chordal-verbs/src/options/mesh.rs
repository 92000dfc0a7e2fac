//! `MeshOptions`: the options of `mesh`, its budget and its result.
use super::effort::{EffortOptions, effort, proof_effort};
use super::values::{angle, count, count_from_0, length, texcoord_distance, word};
use super::{ANGLE, COUNT, LENGTH, OptionRow, OptionSection, OptionTable, OptionValues, store, store_some};
use crate::{BudgetSpec, Effort, Normals, SolidOffset, Spacing, parse_time};
use chordal::budget::advice::{Message, Setting};
use chordal::budget::attributes::AttributeLimits;
use chordal::budget::proof::ProofEffort;
use chordal::budget::{PixelBudget, Pixels, RequiredEvidence, View};
use chordal_io::Format;
use std::time::Duration;

/// A request for a mesh, as far as it is known before the shape is.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeshOptions {
    /// All of the budget but its pixels, which need a view: see [`Self::spec`].
    budget: BudgetSpec,
    pixels: Option<Pixels>,
    view: Option<View>,
    effort: Option<Effort>,
    /// Whether the best result is kept if the budget is not met.
    pub keep_best: bool,
    /// The time after which the best result counts, for fields.
    pub within: Option<Duration>,
    /// The rounds of subdivision after which the polygons of a cage are the result.
    pub level: Option<u32>,
    /// The format of the result, if it is named.
    pub to: Option<Format>,
}

impl MeshOptions {
    /// The budget.
    ///
    /// # Errors
    /// If there are pixels without a view, or a view without pixels.
    pub fn spec(&self) -> Result<BudgetSpec, Message> {
        let pixels = match (self.pixels, self.view) {
            (Some(pixels), Some(view)) => Some(PixelBudget { pixels, view }),
            (None, None) => None,
            (Some(pixels), None) => {
                let message = Message::from("a budget in pixels needs a view: add ");
                let message = message.value(Setting::View, "1920x1080 fov=45 dist=4").words(" to ");
                return Err(message.value(Setting::Px, pixels.get()));
            }
            (None, Some(_)) => {
                let message = Message::from("a view is for a budget in pixels: add ");
                return Err(message.value(Setting::Px, 1));
            }
        };
        let spec = BudgetSpec { pixels, effort: self.effort.unwrap_or_default(), ..self.budget };
        Ok(spec.with_usual_length())
    }

    /// What is missing if there is no limit.
    #[must_use]
    pub fn no_limit() -> Message {
        Message::from("a budget is needed: ")
            .setting(Setting::Tol)
            .words(", ")
            .setting(Setting::Px)
            .words(" with ")
            .setting(Setting::View)
            .words(", ")
            .setting(Setting::Triangles)
            .words(" or ")
            .setting(Setting::Segments)
    }

    /// How far the proof of a field is taken: to its end if the best was asked for.
    #[must_use]
    pub fn proof(&self) -> ProofEffort {
        proof_effort(self.effort)
    }

    /// The evidence that is required, if it was said.
    #[must_use]
    pub fn require(&self) -> Option<RequiredEvidence> {
        self.budget.require
    }

    /// Whether a drawing is to become a solid.
    #[must_use]
    pub fn extrudes(&self) -> bool {
        self.budget.extrude.is_some()
    }

    /// The normals that triangles get.
    #[must_use]
    pub fn normals(&self) -> Normals {
        self.budget.normals
    }
}

/// Limits on attributes, which `mesh` and `lod` share.
pub(super) trait AttributeOptions {
    fn attributes(&mut self) -> &mut AttributeLimits;
}

impl AttributeOptions for MeshOptions {
    fn attributes(&mut self) -> &mut AttributeLimits {
        &mut self.budget.attributes
    }
}

impl EffortOptions for MeshOptions {
    fn effort(&mut self) -> &mut Option<Effort> {
        &mut self.effort
    }
}

pub(super) const fn uv_error<S: AttributeOptions>() -> OptionRow<S> {
    OptionRow::<S>::new(
        "uv-error",
        (OptionValues::Number, "DISTANCE"),
        "For triangles with texture coordinates, with a length or pixels: maximum distance to the input's, 0.01 or 1% of the \
         texture's side. Measured",
        |options, text| {
            let limits = options.attributes();
            store(limits, AttributeLimits::new(Some(texcoord_distance(text)?), limits.normal_deg()))
        },
    )
}

pub(super) const fn normal_error<S: AttributeOptions>() -> OptionRow<S> {
    OptionRow::<S>::new(
        "normal-error",
        ANGLE,
        "For triangles with normals, with a length or pixels: maximum angle to the input's, e.g. 10deg. Measured; flat \
         shading follows the faces",
        |options, text| {
            let limits = options.attributes();
            store(limits, AttributeLimits::new(limits.texcoord(), Some(angle(text)?)))
        },
    )
}

/// The group of the options that limit the error or the size of the result.
const LIMITS: &str = "budget";

const EVIDENCE: OptionValues = OptionValues::Words(&[
    ("proved", "A proof; the exit code is 5 if there is none"),
    ("proved-or-measured", "A proof, else samples: the default"),
    ("measured", "Samples: faster"),
    ("estimated", "An instant draft whose distance nobody knows"),
]);
const SPACINGS: OptionValues = OptionValues::Words(&[
    ("fewest", "As few segments as possible, or nearly"),
    ("even", "Equal steps of the parameter"),
]);

impl OptionTable for MeshOptions {
    const ROWS: &'static [OptionRow<Self>] = &[
        OptionRow::<Self>::new(
            "tol",
            LENGTH,
            "Maximum distance to the true shape: 0.1, 0.1mm, or 0.05% of the diagonal of its bounding box",
            |options, text| store_some(&mut options.budget.length, length(text)),
        )
        .in_groups(&[LIMITS]),
        OptionRow::<Self>::new(
            "px",
            (OptionValues::Number, "PIXELS"),
            "Maximum distance on the screen of {view}, in device pixels",
            |options, text| store_some(&mut options.pixels, text.parse()),
        )
        .renamed("pixels")
        .in_groups(&[LIMITS]),
        OptionRow::<Self>::new(
            "view",
            (OptionValues::Text, "VIEW"),
            "The camera that {px} is for: \"1920x1080 fov=45 dist=4\" for any direction, at least 4 units from the bounding \
             box; \"1920x1080 fov=45 eye=1,2,3 target=0,0,0\" for one position; height=LENGTH instead of fov for an \
             orthographic camera",
            |options, text| store_some(&mut options.view, text.parse()),
        ),
        OptionRow::<Self>::new(
            "angle",
            ANGLE,
            "For smooth surfaces, with another limit: maximum angle between the normals of the triangles and those of the \
             shape, e.g. 5deg",
            |options, text| store_some(&mut options.budget.angle_deg, angle(text)),
        )
        .needs(LIMITS),
        uv_error(),
        normal_error(),
        OptionRow::<Self>::new(
            "triangles",
            COUNT,
            "Maximum number of triangles: the best mesh with at most N",
            |options, text| store_some(&mut options.budget.triangles, count(text)),
        )
        .in_groups(&[LIMITS]),
        OptionRow::<Self>::new(
            "segments",
            COUNT,
            "For curves to polylines (.svg, .json): maximum number of segments in total",
            |options, text| store_some(&mut options.budget.segments, count(text)),
        )
        .in_groups(&[LIMITS]),
        OptionRow::<Self>::new(
            "require",
            (EVIDENCE, "EVIDENCE"),
            "Evidence required for a field. By default a proof is tried for about as long as meshing took; if it does not end, \
             the mesh is measured, and the places without a proof are listed. Other inputs are proved",
            |options, text| store_some(&mut options.budget.require, text.parse()),
        ),
        OptionRow::<Self>::flag(
            "keep-best",
            "Write the best result even if the budget is not met, as always for fields; the exit code is still 5",
            |options, _| {
                options.keep_best = true;
                Ok(())
            },
        )
        .without_keyword(),
        OptionRow::<Self>::output_format(|options, text| store_some(&mut options.to, text.parse())),
        OptionRow::<Self>::new(
            "spacing",
            (SPACINGS, "HOW"),
            "For curves: the fewest segments within the budget, or equal steps of each piece's parameter",
            |options, text| {
                let words = [("fewest", Spacing::Fewest), ("even", Spacing::Even)];
                store(&mut options.budget.spacing, word(text, &words))
            },
        )
        .default("fewest")
        .under(OptionSection::Result),
        effort(
            "How far to go for the best result. For a field: best takes its proof to the end; by default it gets about the \
             work of meshing. For a mesh or a volume with {triangles} alone: best, the default, has the least error; fast \
             takes about a tenth of the time for two to three times the error",
        )
        .under(OptionSection::Result),
        OptionRow::<Self>::new(
            "within",
            (OptionValues::Time, "TIME"),
            "For a field: write the best result after this time, e.g. 20s or 2m. Default: 60s, or no limit with {require=proved} or \
             {effort=best}",
            |options, text| store_some(&mut options.within, parse_time(text)),
        )
        .under(OptionSection::Result),
        OptionRow::<Self>::new(
            "normals",
            (OptionValues::Text, "HOW"),
            "Normals of triangles: those of the shape or, for .obj, .glb, .gltf, .usda and .usdz, crease=30deg if it has none \
             and is not from a .glb or .gltf (auto); keep (none are added); flat; smooth; crease=ANGLE (smooth up to that \
             angle); groups (the smoothing groups of an .obj)",
            |options, text| store(&mut options.budget.normals, text.parse()),
        )
        .default("auto")
        .under(OptionSection::Result)
        .without_keyword(),
        OptionRow::<Self>::new(
            "extrude",
            LENGTH,
            "For a drawing or letters: extrude to solids of this height, which stand on z = 0; 2, 2mm, or 10% of the diagonal \
             of the bounding box",
            |options, text| store_some(&mut options.budget.extrude, length(text)),
        )
        .conflicts(&["level"])
        .under(OptionSection::Result),
        OptionRow::<Self>::new(
            "bevel",
            LENGTH,
            "With {extrude}: bevel the edges of both ends at 45°, this wide and less than half the height; if a stroke is \
             narrower than two bevels, they meet in a ridge",
            |options, text| store_some(&mut options.budget.bevel, length(text)),
        )
        .needs("extrude")
        .under(OptionSection::Result),
        OptionRow::<Self>::new(
            "offset",
            LENGTH,
            "For a closed mesh: its surface moved outward by this distance, or inward if it is negative; 0.5mm, -0.5mm or 1% of \
             the diagonal. The default tolerance is a twentieth of it",
            |options, text| store_some(&mut options.budget.offset, SolidOffset::parse(text)),
        )
        .conflicts(&["extrude", "level"])
        .under(OptionSection::Result)
        .without_keyword(),
        OptionRow::<Self>::new(
            "hollow",
            LENGTH,
            "For a closed mesh: a cavity in it that leaves a wall of this thickness. The default tolerance is a twentieth of it",
            |options, text| store_some(&mut options.budget.offset, length(text).map(SolidOffset::Hollow)),
        )
        .conflicts(&["extrude", "level", "offset"])
        .under(OptionSection::Result)
        .without_keyword(),
        OptionRow::<Self>::new(
            "level",
            (OptionValues::Count, "N"),
            "For a polygon cage (.obj): write its polygons after N rounds of subdivision instead of its smooth surface; 0 \
             keeps them",
            |options, text| store_some(&mut options.level, count_from_0(text)),
        )
        .conflicts(&[LIMITS])
        .under(OptionSection::Result)
        .without_keyword(),
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(options: &[(&str, &str)]) -> Result<BudgetSpec, String> {
        let mut all = MeshOptions::default();
        options.iter().try_for_each(|(name, text)| all.set(name, text))?;
        all.spec().map_err(|message| message.to_string())
    }

    #[test]
    fn pixels_and_a_view_belong_together() {
        assert!(spec(&[("px", "1")]).is_err());
        assert!(spec(&[("view", "100x100 fov=45 dist=4")]).is_err());
        let both = spec(&[("px", "2"), ("view", "100x100 fov=45 dist=4")]).expect("both are given");
        assert!(both.has_limit());
    }

    #[test]
    fn limits_on_attributes_add_up_in_any_order() {
        let one = spec(&[("uv-error", "1%"), ("normal-error", "10deg")]).expect("both are limits");
        let other = spec(&[("normal-error", "10"), ("uv-error", "0.01")]).expect("both are limits");
        assert_eq!(one, other);
        assert_eq!((one.attributes.texcoord(), one.attributes.normal_deg()), (Some(0.01), Some(10.0)));
    }

    #[test]
    fn effort_is_best_unless_said_and_takes_proofs_to_their_end_only_if_said() {
        let mut options = MeshOptions::default();
        assert_eq!(options.proof(), ProofEffort::default());
        options.set("effort", "best").expect("a word of its list");
        assert_eq!(options.proof(), ProofEffort::Full);
        options.set("effort", "fast").expect("a word of its list");
        assert_eq!(options.spec().expect("nothing else is given").effort, Effort::Fast);
        assert_eq!(options.set("effort", "slow"), Err("'best' or 'fast', not 'slow'".to_owned()));
    }

    #[test]
    fn values_without_sense_are_refused_by_their_option() {
        for (name, text) in [
            ("tol", "-1"),
            ("px", "0"),
            ("angle", "0"),
            ("uv-error", "-1%"),
            ("triangles", "0"),
            ("segments", "1.5"),
            ("require", "hoped"),
            ("spacing", "odd"),
            ("within", "soon"),
            ("normals", "rough"),
            ("level", "-1"),
            ("to", "doc"),
            ("nothing", "1"),
        ] {
            assert!(MeshOptions::default().set(name, text).is_err(), "{name} {text}");
        }
    }
}
