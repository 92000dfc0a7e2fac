//! Checks the attributes of a file, and the facts about them in its certificate: normals, texture coordinates, colours.
//! They are compared with those of the input; attributes for which there is no comparison are listed as unchecked.
use super::attribute_pair::{AttributePair, CornerDifferences, PairForm, ValueBox, is_direction};
use super::claims::ClaimList;
use super::normals::{are_computed, share_backwards, stated_normals};
use crate::report::AttributeFacts;
use crate::scene::flatten;
use crate::scene::frame_nodes::without_frame_nodes;
use crate::{Input, MeshFailure, Normals, Shape};
use chordal::Job;
use chordal::explicit::Semantic;
use chordal::math::{greater, lesser};
use chordal_io::glb::VertexStorage;
use chordal_io::{Frame, Scene, TextureOrigin};
use serde_json::Value;
use std::cell::OnceCell;

/// A file that a step wrote, the input of that step, and the certificate.
pub(super) struct AttributeJudge<'a> {
    pub certificate: &'a Value,
    pub read: &'a Input,
    pub written: &'a Input,
    /// The frame of the certificate.
    pub frame: &'a Frame,
    /// The largest distance that points moved.
    pub moved: f64,
    pub verb: &'a str,
    /// Whether the input was put together.
    pub is_composed: bool,
    pub job: &'a Job,
}

impl AttributeJudge<'_> {
    /// Claims are called `attributes/NAME`, and so are unchecked attributes; unchecked figures are listed by their paths.
    pub fn check(&self, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        let stated = self.certificate.get("attributes").and_then(Value::as_array);
        let stated = stated.map_or(&[][..], |stated| &stated[..]);
        let Shape::Scene(scene) = &self.written.shape else {
            if let Shape::Cage(polygons) = &self.written.shape
                && (polygons.cage.texcoords().is_some() || !polygons.attributes.is_empty())
            {
                claims.pass("attributes of polygons");
            }
            if !stated.is_empty() {
                claims.open("attributes", "there is no judge for attributes of other shapes than triangles");
            }
            return Ok(());
        };
        if !scene.assets.materials.is_empty() {
            claims.pass("materials");
        }
        let kinds = semantics_of(scene);
        if kinds.is_empty() && stated.is_empty() {
            return Ok(());
        }
        if stated.is_empty() && scene.parts.iter().all(|part| part.mesh.faces().is_empty()) {
            // Points alone have no corners.
            kinds.iter().for_each(|kind| claims.pass(claim_of(kind)));
            return Ok(());
        }
        let written = &without_frame_nodes(scene, self.written.format, self.frame);
        let comparison = AttributeComparison {
            judge: self,
            written,
            pairs: match &self.read.shape {
                Shape::Scene(read) => self.pairs_of(read, scene, written),
                _ => Vec::new(),
            },
        };
        let mut claimed = Vec::with_capacity(stated.len());
        for (k, facts) in stated.iter().enumerate() {
            claimed.extend(comparison.check_facts((k, facts), &kinds, claims)?);
        }
        for kind in kinds.iter().filter(|kind| !claimed.contains(*kind)) {
            comparison.check_unclaimed(kind, claims)?;
        }
        Ok(())
    }

    /// The forms in which to compare, the likeliest first.
    fn pairs_of<'s>(&self, read: &'s Scene, file: &Scene, written: &'s Scene) -> Vec<ScenePair<'s>> {
        let origins = [read, file].map(|scene| scene.frame.texture_origin);
        let turns_v = matches!(origins, [Some(a), Some(b)] if a != b);
        let plain = PairForm { turns_v, is_whole: false, is_unplaced: false };
        let mut forms = vec![plain];
        if [read, written].into_iter().any(flatten::is_posed) {
            forms.push(PairForm { is_unplaced: true, ..plain });
        }
        if [read, written].into_iter().any(|scene| scene.parts.len() > 1 || scene.nodes.len() > 1) {
            forms.push(PairForm { is_whole: true, ..plain });
        }
        // For an input that was put together, the origin of texture coordinates may be unknown.
        if self.is_composed && origins.contains(&None::<TextureOrigin>) {
            let flipped: Vec<PairForm> =
                forms.iter().map(|form| PairForm { turns_v: !turns_v, ..*form }).collect();
            forms.extend(flipped);
        }
        let pair =
            |form| ScenePair { scenes: [read, written], form, pair: OnceCell::new(), facts: OnceCell::new() };
        forms.into_iter().map(pair).collect()
    }
}

/// The factor for how much farther points may have moved before a skin posed them. Chosen: a larger search only makes the
/// measured deviation smaller, so that a figure is listed as unchecked and not refuted.
const UNPOSED: f64 = 4.0;

/// Two scenes in a form, compared on demand.
struct ScenePair<'s> {
    scenes: [&'s Scene; 2],
    form: PairForm,
    pair: OnceCell<Option<AttributePair>>,
    facts: OnceCell<Vec<AttributeFacts>>,
}

impl ScenePair<'_> {
    fn pair(&self) -> Result<Option<&AttributePair>, MeshFailure> {
        if self.pair.get().is_none() {
            let created = AttributePair::new(self.scenes, self.form)?;
            return Ok(self.pair.get_or_init(|| created).as_ref());
        }
        Ok(self.pair.get().and_then(Option::as_ref))
    }

    /// The deviations of attributes from those at the nearest places.
    ///
    /// The certificate does not say how far points moved before they were posed, so the values beside a seam may come from
    /// that much farther.
    fn facts(&self, judge: &AttributeJudge<'_>) -> Result<&[AttributeFacts], MeshFailure> {
        if self.facts.get().is_none() {
            let reach = if self.form.is_unplaced { UNPOSED * judge.moved } else { judge.moved };
            let measured = match self.pair()? {
                Some(pair) => pair.measure(reach, judge.job)?,
                None => None,
            };
            return Ok(self.facts.get_or_init(|| measured.unwrap_or_default()));
        }
        Ok(self.facts.get().map_or(&[], |facts| facts))
    }

    fn facts_of(
        &self,
        judge: &AttributeJudge<'_>,
        semantic: &Semantic,
    ) -> Result<Option<&AttributeFacts>, MeshFailure> {
        let names = AttributeFacts::names_of(semantic);
        let facts = self.facts(judge)?;
        Ok(facts.iter().find(|facts| (facts.semantic, &facts.name) == (names.0, &names.1)))
    }
}

/// The result of comparing a claimed figure with the measured one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum FigureMatch {
    Same,
    /// It claims more than is measured, or is a little too small: of equally near places a different one may be taken.
    Unclear,
    /// It is too small.
    Wrong,
}

/// A judge with the data that it compares.
struct AttributeComparison<'a> {
    judge: &'a AttributeJudge<'a>,
    /// The file, without nodes of its frame.
    written: &'a Scene,
    /// Empty if the input has no triangles.
    pairs: Vec<ScenePair<'a>>,
}

/// The keys of the facts of an attribute.
const KEYS: [&str; 7] = ["semantic", "name", "largest", "rms", "unit", "evidence", "samples"];
/// The kinds of attributes.
const KINDS: [&str; 5] = ["normal", "tangent", "texcoord", "color", "custom"];

impl AttributeComparison<'_> {
    /// Checks the facts of the certificate about one attribute; returns which one that is, if the file has it.
    fn check_facts(
        &self,
        (k, facts): (usize, &Value),
        kinds: &[Semantic],
        claims: &mut ClaimList,
    ) -> Result<Option<Semantic>, MeshFailure> {
        let path = format!("attributes/{k}");
        let text = |key: &str| facts.get(key).and_then(Value::as_str).unwrap_or("");
        for (key, _) in facts.as_object().into_iter().flatten().filter(|(key, _)| !KEYS.contains(&&key[..])) {
            claims.open(&format!("{path}/{key}"), "a certificate of this version has no such fact");
        }
        let (kind, name) = (text("semantic"), text("name"));
        if !KINDS.contains(&kind) {
            claims.refute(&format!("{path}/semantic"), format!("there are no attributes called '{kind}'"));
            return Ok(None);
        }
        let is_named = |semantic: &&Semantic| AttributeFacts::names_of(semantic) == (kind, name.to_owned());
        let Some(semantic) = kinds.iter().find(is_named) else {
            let had = self.pairs.first().map(|pair| semantics_of(pair.scenes[0])).unwrap_or_default();
            if kind == "custom" || had.iter().any(|semantic| is_named(&semantic)) {
                // The format does not hold it, or under another name.
                claims.pass(path);
            } else {
                let reason = format!("neither the file nor its input has '{name}'");
                claims.refute(&format!("{path}/name"), reason);
            }
            return Ok(None);
        };
        let unit = if is_direction(semantic) { "degrees" } else { "value" };
        for (key, expected) in [("unit", unit), ("evidence", "measured")] {
            if text(key) != expected {
                let reason = format!("for '{name}' it is {expected}, and '{}' is claimed", text(key));
                claims.refute(&format!("{path}/{key}"), reason);
            }
        }
        self.check_figures((&path, facts), semantic, claims)?;
        Ok(Some(semantic.clone()))
    }

    /// Checks that the figures are those measured between the file and the input.
    fn check_figures(
        &self,
        (path, facts): (&str, &Value),
        semantic: &Semantic,
        claims: &mut ClaimList,
    ) -> Result<(), MeshFailure> {
        let tolerance = self.tolerance(semantic)?;
        let claimed = ["largest", "rms"].map(|key| facts.get(key).and_then(Value::as_f64));
        // In which form the writer measured is not known: the form that agrees best counts.
        let mut best: Option<([FigureMatch; 2], &AttributeFacts)> = None;
        let mut has_samples = false;
        for pair in &self.pairs {
            let Some(measured) = pair.facts_of(self.judge, semantic)? else { continue };
            let matches = [
                compare(claimed[0], measured.largest, tolerance),
                compare(claimed[1], measured.rms, tolerance),
            ];
            has_samples |= facts.get("samples").and_then(Value::as_u64) == Some(measured.samples);
            if best.as_ref().is_none_or(|(before, _)| matches.iter().max() < before.iter().max()) {
                best = Some((matches, measured));
            }
            if matches == [FigureMatch::Same; 2] {
                break;
            }
        }
        let claim = claim_of(semantic);
        let Some((matches, facts)) = best else {
            claims.open(&claim, "its deviation could not be measured again");
            return Ok(());
        };
        if !has_samples {
            claims.pass(format!("{path}/samples"));
        }
        let measured = [facts.largest, facts.rms];
        for (k, key) in ["largest", "rms"].into_iter().enumerate() {
            let figure = format!("{path}/{key}");
            let number = |x: Option<f64>| x.map_or("no number".to_owned(), |x| format!("{x:?}"));
            match matches[k] {
                FigureMatch::Same => {}
                FigureMatch::Unclear => claims.pass(figure),
                FigureMatch::Wrong => {
                    let [was, is] = [claimed[k], measured[k]].map(number);
                    let reason = format!("it is off by {is}, and {was} is claimed");
                    // The mean does not depend on which of several equally near places is taken.
                    if key == "rms" { claims.refute(&figure, reason) } else { claims.open(&figure, reason) }
                }
            }
        }
        if matches == [FigureMatch::Same; 2] {
            claims.prove(&claim);
        }
        Ok(())
    }

    /// Checks an attribute without facts in the certificate.
    fn check_unclaimed(&self, semantic: &Semantic, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        let claim = claim_of(semantic);
        let had = match self.pairs.first() {
            Some(pair) => semantics_of(pair.scenes[0]),
            None => return self.check_new(&claim, semantic, claims),
        };
        if !had.contains(semantic) {
            let is_of_kind = |own: &Semantic| std::mem::discriminant(own) == std::mem::discriminant(semantic);
            match semantic {
                Semantic::Normal => return self.check_normals(&claim, None, claims),
                Semantic::TexCoord(_) | Semantic::Color(_) if !had.iter().any(is_of_kind) => {
                    claims.open(&claim, "the file has it, and the input has nothing of the kind");
                }
                // Formats number sets anew, and use their own names.
                _ => claims.pass(claim),
            }
            return Ok(());
        }
        self.check_carried(&claim, semantic, claims)
    }

    /// Checks an attribute that the input has, too.
    fn check_carried(
        &self,
        claim: &str,
        semantic: &Semantic,
        claims: &mut ClaimList,
    ) -> Result<(), MeshFailure> {
        /// Directions with a larger mean deviation are turned over. Chosen: far above the deviations of coarse levels, see
        /// `is_roughly`.
        const TURNED_OVER_DEG: f64 = 120.0;
        let tolerance = self.tolerance(semantic)?;
        // 1. The same triangles, with the same values.
        let (mut matched, mut is_partial) = (None, false);
        for pair in self.pairs.iter().filter(|pair| !pair.form.is_unplaced) {
            let differences =
                pair.pair()?.and_then(|pair| pair.by_corners(semantic, (self.judge.moved, tolerance)));
            let Some(differences) = differences.filter(|all| all.compared > 0) else { continue };
            if differences.different == 0 && differences.missing == 0 {
                claims.prove(claim);
                return Ok(());
            }
            is_partial |= differences.missing > 0;
            matched = matched.or(Some(differences).filter(|all| all.different > 0));
        }
        // 2. The same values at the nearest places, or roughly the same.
        let (mut least, mut is_like): (Option<f64>, bool) = (None, false);
        for pair in &self.pairs {
            let Some(facts) = pair.facts_of(self.judge, semantic)? else { continue };
            let is_same = facts.largest.is_some_and(|largest| largest <= tolerance);
            if is_same && matched.is_none() && !is_partial {
                claims.prove(claim);
                return Ok(());
            }
            let rms = facts.rms.unwrap_or(f64::INFINITY);
            least = Some(least.map_or(rms, |least| lesser(rms, least)));
            if let Some(both) = pair.pair()? {
                is_like |= is_roughly(semantic, rms, both.boxes(semantic), tolerance);
            }
        }
        // 3. Normals that were computed according to the certificate, and normals without a comparison.
        if *semantic == Semantic::Normal {
            let method = stated_normals(self.judge.certificate);
            if method.is_some() || matched.is_none() && (least.is_none() || is_partial) {
                return self.check_normals(claim, method, claims);
            }
        }
        // 4. Similar values on different triangles, and attributes that formats store in forms of their own.
        let is_free = matches!(semantic, Semantic::Custom(_) | Semantic::Blended(_) | Semantic::Tangent);
        if is_free || is_like && (matched.is_none() || self.may_change()) {
            claims.pass(claim);
            return Ok(());
        }
        let (reason, is_most) = match (matched, least) {
            (Some(CornerDifferences { compared, different, .. }), _) => {
                let reason = format!("{different} of {compared} corners have other values than in the input");
                (reason, 2 * different > compared)
            }
            (None, Some(difference)) => {
                let is_turned = is_direction(semantic) && difference > TURNED_OVER_DEG;
                (format!("it is off by {difference:?} from the input, and nothing explains that"), is_turned)
            }
            (None, None) => ("it cannot be compared with that of the input".to_owned(), false),
        };
        if is_most {
            claims.refute(claim, reason)
        } else {
            claims.open(claim, reason)
        }
        Ok(())
    }

    /// Whether the step may have changed attributes of triangles that it kept.
    fn may_change(&self) -> bool {
        let mended = self.judge.certificate.get("mended").and_then(Value::as_array);
        let is_posed = self.pairs.iter().any(|pair| pair.form.is_unplaced);
        mended.is_some_and(|repairs| !repairs.is_empty()) || is_posed || self.judge.verb == "lod"
    }

    /// Checks an attribute of triangles that were built for a shape of another kind.
    fn check_new(&self, claim: &str, semantic: &Semantic, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        let polygons = match &self.judge.read.shape {
            Shape::Cage(polygons) => Some(polygons),
            _ => None,
        };
        let texcoords = polygons.and_then(|polygons| polygons.cage.texcoords());
        match semantic {
            Semantic::Normal => return self.check_normals(claim, None, claims),
            Semantic::TexCoord(_) if texcoords.is_some() => {
                let rows =
                    texcoords.into_iter().flat_map(|attribute| attribute.values.iter().map(|row| &row[..]));
                let values = self.written.parts.iter().filter_map(|part| part.mesh.attribute(semantic));
                let values_box = ValueBox::of_rows(
                    values.flat_map(|attribute| attribute.values.chunks(attribute.width.max(1))),
                );
                let tolerance = self.tolerance(semantic)?;
                let may_be = |mut polygon_box: ValueBox| {
                    // v may be flipped: some formats count it from the bottom of a picture, others from the top.
                    let is_like = |written: &ValueBox| written.may_be_of(&polygon_box, tolerance);
                    let is_plain = values_box.as_ref().is_some_and(is_like);
                    (polygon_box.min[1], polygon_box.max[1]) =
                        (1.0 - polygon_box.max[1], 1.0 - polygon_box.min[1]);
                    is_plain
                        || values_box
                            .as_ref()
                            .is_some_and(|written| written.may_be_of(&polygon_box, tolerance))
                };
                if ValueBox::of_rows(rows).is_none_or(may_be) {
                    claims.pass(claim);
                } else {
                    claims.open(claim, "its values are not in the range of those of the polygons");
                }
            }
            Semantic::TexCoord(_) | Semantic::Color(_)
                if polygons.is_none_or(|polygons| polygons.attributes.is_empty()) =>
            {
                claims.open(claim, "the file has it, and the input has nothing of the kind");
            }
            _ => claims.pass(claim),
        }
        Ok(())
    }

    /// Checks computed normals: by the method in the certificate, or, for an input without normals, by the usual one;
    /// otherwise they are the normals of the shape, which point to the front.
    fn check_normals(
        &self,
        claim: &str,
        method: Option<Normals>,
        claims: &mut ClaimList,
    ) -> Result<(), MeshFailure> {
        /// The share of the area whose normals may point backwards. Chosen: normals of noisy samples do.
        const SOME: f64 = 0.25;
        /// With a larger share, the normals are turned over. Defined: half of the area.
        const MOST: f64 = 0.5;
        let method = method.or_else(|| stated_normals(self.judge.certificate));
        let method = method.or_else(|| (!self.pairs.is_empty()).then_some(Normals::USUAL));
        if let Some(method) = method
            && are_computed(self.written, method, self.tolerance(&Semantic::Normal)?)?
        {
            claims.prove(claim);
            return Ok(());
        }
        let share = share_backwards(self.written);
        let reason = format!("{:.0} % of the area has normals that point backwards", 100.0 * share);
        if share > MOST {
            claims.refute(claim, reason);
        } else if share > SOME {
            claims.open(claim, reason);
        } else {
            claims.pass(claim);
        }
        Ok(())
    }

    /// The tolerance for rounding by formats: in degrees for directions.
    fn tolerance(&self, semantic: &Semantic) -> Result<f64, MeshFailure> {
        /// For single precision. Chosen: with room for a product of matrices.
        const DIRECTION_DEG: f64 = 0.01;
        /// For eight bits, as glTF may store directions. Derived: 0.391° and the above.
        const SHORT_DIRECTION_DEG: f64 = 0.401;
        /// A share of the largest value. Chosen: above the rounding of single precision and of six digits.
        const SHARE: f64 = 2e-6;
        /// Derived: two steps of eight bits.
        const COLOR: f64 = 2.0 / 255.0;
        let is_short = self.written.stored.is_quantized;
        if is_direction(semantic) {
            return Ok(if is_short { SHORT_DIRECTION_DEG } else { DIRECTION_DEG });
        }
        let values = self.written.parts.iter().filter_map(|part| part.mesh.attribute(semantic));
        let values = ValueBox::of_rows(values.flat_map(|own| own.values.chunks(own.width.max(1))));
        let rounded = SHARE * greater(values.map_or(0.0, |values| values.largest()), 1.0);
        Ok(match semantic {
            Semantic::Color(_) => COLOR,
            Semantic::TexCoord(_) if is_short => rounded + VertexStorage::WORST_TEXCOORD,
            _ => rounded,
        })
    }
}

/// Whether values with that mean deviation are roughly those of the input.
fn is_roughly(semantic: &Semantic, rms: f64, [was, is]: [Option<ValueBox>; 2], tolerance: f64) -> bool {
    /// Chosen: directions of coarse levels deviate by some tens of degrees.
    const TURNED_DEG: f64 = 60.0;
    /// The share of the range of values. Chosen: if all values are equally frequent, a constant value deviates by 0.29.
    const SHARE: f64 = 0.25;
    if is_direction(semantic) {
        return rms <= TURNED_DEG;
    }
    let Some((was, is)) = was.zip(is) else { return false };
    rms <= SHARE * was.diagonal() + tolerance && is.may_be_of(&was, tolerance)
}

/// Compares a claimed figure with the measured one; `None` is not a number.
fn compare(claimed: Option<f64>, measured: Option<f64>, tolerance: f64) -> FigureMatch {
    /// The share by which rounded figures may differ. Chosen: a larger share misses more edits, a smaller one refutes
    /// rounding.
    const SAME: f64 = 1e-3;
    /// The factor by which a measured figure may be larger. Chosen: of equally near places a different one may be taken.
    const NEAR: f64 = 1.25;
    match (claimed, measured) {
        (None, None) => FigureMatch::Same,
        (None, Some(_)) => FigureMatch::Unclear,
        (Some(_), None) => FigureMatch::Wrong,
        (Some(claimed), Some(measured)) => {
            let is_same = (claimed - measured).abs() <= tolerance + SAME * greater(claimed, measured);
            let is_near = measured <= NEAR * claimed + tolerance;
            match (is_same, is_near) {
                (true, _) => FigureMatch::Same,
                (_, true) => FigureMatch::Unclear,
                _ => FigureMatch::Wrong,
            }
        }
    }
}

/// The name of the claim about an attribute.
fn claim_of(semantic: &Semantic) -> String {
    format!("attributes/{}", AttributeFacts::names_of(semantic).1)
}

/// The attributes of a scene except groups: names and materials are not checked here.
fn semantics_of(scene: &Scene) -> Vec<Semantic> {
    let mut semantics: Vec<Semantic> = Vec::new();
    for attribute in scene.parts.iter().flat_map(|part| part.mesh.attributes()) {
        let is_group = matches!(attribute.semantic, Semantic::Group(_));
        if !is_group && !semantics.contains(&attribute.semantic) {
            semantics.push(attribute.semantic.clone());
        }
    }
    semantics
}
