//! What a file holds beside its triangles and what its certificate says of that: normals, texture coordinates, colours. They
//! are compared with those of what was read; of what nothing can tell it is said that it was not checked.
use super::attribute_pair::{AttributePair, CornerDifferences, PairForm, ValueBox, is_direction};
use super::claims::ClaimList;
use super::normals::{are_computed, said_normals, share_backwards};
use crate::frame_nodes::without_frame_nodes;
use crate::report::AttributeFacts;
use crate::{Input, MeshFailure, Normals, Shape, flatten};
use chordal::Job;
use chordal::explicit::Semantic;
use chordal::math::{greater, lesser};
use chordal_io::glb::VertexStorage;
use chordal_io::{Frame, Scene, TextureOrigin};
use serde_json::Value;
use std::cell::OnceCell;

/// A file that a step wrote, what that step read, and the certificate.
pub(super) struct AttributeJudge<'a> {
    pub certificate: &'a Value,
    pub read: &'a Input,
    pub written: &'a Input,
    /// The frame of the certificate.
    pub frame: &'a Frame,
    /// How far points moved at most.
    pub moved: f64,
    pub verb: &'a str,
    /// Whether what was read was put together.
    pub is_composed: bool,
    pub job: &'a Job,
}

impl AttributeJudge<'_> {
    /// Claims are called `attributes/NAME`; so is what is left unchecked, and figures of the certificate by their paths.
    pub fn check(&self, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        let said = self.certificate.get("attributes").and_then(Value::as_array);
        let said = said.map_or(&[][..], |said| &said[..]);
        let Shape::Scene(scene) = &self.written.shape else {
            if let Shape::Cage(polygons) = &self.written.shape
                && (polygons.cage.texcoords().is_some() || !polygons.attributes.is_empty())
            {
                claims.pass("attributes of polygons");
            }
            if !said.is_empty() {
                claims.open("attributes", "there is no judge of attributes of other shapes than triangles");
            }
            return Ok(());
        };
        if !scene.assets.materials.is_empty() {
            claims.pass("materials");
        }
        let kinds = semantics_of(scene);
        if kinds.is_empty() && said.is_empty() {
            return Ok(());
        }
        if said.is_empty() && scene.parts.iter().all(|part| part.mesh.faces().is_empty()) {
            // Points alone have no corners.
            kinds.iter().for_each(|kind| claims.pass(claim_of(kind)));
            return Ok(());
        }
        let written = &without_frame_nodes(scene, self.written.format, self.frame);
        let look = AttributeLook {
            judge: self,
            written,
            pairs: match &self.read.shape {
                Shape::Scene(read) => self.pairs_of(read, scene, written),
                _ => Vec::new(),
            },
        };
        let mut spoken_of = Vec::with_capacity(said.len());
        for (k, facts) in said.iter().enumerate() {
            spoken_of.extend(look.check_facts((k, facts), &kinds, claims)?);
        }
        for kind in kinds.iter().filter(|kind| !spoken_of.contains(*kind)) {
            look.check_unclaimed(kind, claims)?;
        }
        Ok(())
    }

    /// The ways to compare, the likeliest first.
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
        // Of what was put together nobody may know where pictures begin.
        if self.is_composed && origins.contains(&None::<TextureOrigin>) {
            let turned: Vec<PairForm> =
                forms.iter().map(|form| PairForm { turns_v: !turns_v, ..*form }).collect();
            forms.extend(turned);
        }
        let pair =
            |form| ScenePair { scenes: [read, written], form, pair: OnceCell::new(), facts: OnceCell::new() };
        forms.into_iter().map(pair).collect()
    }
}

/// How many times as far points may have moved before a skin posed them as after it. Chosen: what is looked for farther away is
/// found nearer to what it was, so that a figure is listed and not refuted.
const UNPOSED: f64 = 4.0;

/// Two scenes in a form, compared when that is asked for.
struct ScenePair<'s> {
    scenes: [&'s Scene; 2],
    form: PairForm,
    pair: OnceCell<Option<AttributePair>>,
    facts: OnceCell<Vec<AttributeFacts>>,
}

impl ScenePair<'_> {
    fn pair(&self) -> Result<Option<&AttributePair>, MeshFailure> {
        if self.pair.get().is_none() {
            let made = AttributePair::new(self.scenes, self.form)?;
            return Ok(self.pair.get_or_init(|| made).as_ref());
        }
        Ok(self.pair.get().and_then(Option::as_ref))
    }

    /// How far attributes are from those at the nearest places.
    ///
    /// Nothing says how far points moved before they were posed: that much farther values beside a seam may come from.
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

/// What is said of a figure, beside what was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum FigureMatch {
    Same,
    /// It claims less than is true, or little more: places that are as near may be taken in another order.
    Unclear,
    /// It claims too much.
    Wrong,
}

/// A judge with what it looks at.
struct AttributeLook<'a> {
    judge: &'a AttributeJudge<'a>,
    /// The file, without nodes of its frame.
    written: &'a Scene,
    /// Empty where what was read is no triangles.
    pairs: Vec<ScenePair<'a>>,
}

/// What the facts of an attribute are called.
const KEYS: [&str; 7] = ["semantic", "name", "largest", "rms", "unit", "evidence", "samples"];
/// What attributes are called.
const KINDS: [&str; 5] = ["normal", "tangent", "texcoord", "color", "custom"];

impl AttributeLook<'_> {
    /// Looks at what the certificate says of one attribute; which one that is, where the file has it.
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
            if kind == "custom" || had.iter().any(|own| is_named(&own)) {
                // The format does not hold it, or by another name.
                claims.pass(path);
            } else {
                let reason = format!("neither the file nor what was read has '{name}'");
                claims.refute(&format!("{path}/name"), reason);
            }
            return Ok(None);
        };
        let unit = if is_direction(semantic) { "degrees" } else { "value" };
        for (key, expected) in [("unit", unit), ("evidence", "measured")] {
            if text(key) != expected {
                let reason = format!("of '{name}' it is {expected}, and '{}' is said", text(key));
                claims.refute(&format!("{path}/{key}"), reason);
            }
        }
        self.check_figures((&path, facts), semantic, claims)?;
        Ok(Some(semantic.clone()))
    }

    /// The figures are those that are measured between the file and what was read.
    fn check_figures(
        &self,
        (path, facts): (&str, &Value),
        semantic: &Semantic,
        claims: &mut ClaimList,
    ) -> Result<(), MeshFailure> {
        let room = self.room(semantic)?;
        let said = ["largest", "rms"].map(|key| facts.get(key).and_then(Value::as_f64));
        let mut best: Option<([FigureMatch; 2], &AttributeFacts)> = None;
        let mut has_samples = false;
        for pair in &self.pairs {
            let Some(found) = pair.facts_of(self.judge, semantic)? else { continue };
            let own = [compare(said[0], found.largest, room), compare(said[1], found.rms, room)];
            has_samples |= facts.get("samples").and_then(Value::as_u64) == Some(found.samples);
            if best.as_ref().is_none_or(|(known, _)| own.iter().max() < known.iter().max()) {
                best = Some((own, found));
            }
            if own == [FigureMatch::Same; 2] {
                break;
            }
        }
        let claim = claim_of(semantic);
        let Some((matches, found)) = best else {
            claims.open(&claim, "how far it is off could not be measured again");
            return Ok(());
        };
        if !has_samples {
            claims.pass(format!("{path}/samples"));
        }
        let measured = [found.largest, found.rms];
        for (k, key) in ["largest", "rms"].into_iter().enumerate() {
            let figure = format!("{path}/{key}");
            let number = |x: Option<f64>| x.map_or("no number".to_owned(), |x| format!("{x:?}"));
            match matches[k] {
                FigureMatch::Same => {}
                FigureMatch::Unclear => claims.pass(figure),
                FigureMatch::Wrong => {
                    let [was, is] = [said[k], measured[k]].map(number);
                    let reason = format!("it is off by {is}, and {was} is claimed");
                    // The mean does not depend on which of several places that are as near is taken.
                    if key == "rms" { claims.refute(&figure, reason) } else { claims.open(&figure, reason) }
                }
            }
        }
        if matches == [FigureMatch::Same; 2] {
            claims.prove(&claim);
        }
        Ok(())
    }

    /// Looks at an attribute of which the certificate says nothing.
    fn check_unclaimed(&self, semantic: &Semantic, claims: &mut ClaimList) -> Result<(), MeshFailure> {
        let claim = claim_of(semantic);
        let had = match self.pairs.first() {
            Some(pair) => semantics_of(pair.scenes[0]),
            None => return self.check_made(&claim, semantic, claims),
        };
        if !had.contains(semantic) {
            let is_of_kind = |own: &Semantic| std::mem::discriminant(own) == std::mem::discriminant(semantic);
            match semantic {
                Semantic::Normal => return self.check_normals(&claim, None, claims),
                Semantic::TexCoord(_) | Semantic::Color(_) if !had.iter().any(is_of_kind) => {
                    claims.open(&claim, "the file has it, and what was read has nothing of the kind");
                }
                // Formats number sets anew, and name what is theirs as they can.
                _ => claims.pass(claim),
            }
            return Ok(());
        }
        self.check_carried(&claim, semantic, claims)
    }

    /// An attribute that what was read has, too.
    fn check_carried(
        &self,
        claim: &str,
        semantic: &Semantic,
        claims: &mut ClaimList,
    ) -> Result<(), MeshFailure> {
        /// Directions that are off by more in the mean are turned over. Chosen: far from what coarse levels are off, see
        /// `is_roughly`.
        const TURNED_OVER_DEG: f64 = 120.0;
        let room = self.room(semantic)?;
        // 1. The same triangles, with the same values.
        let (mut matched, mut is_partial) = (None, false);
        for pair in self.pairs.iter().filter(|pair| !pair.form.is_unplaced) {
            let found = pair.pair()?.and_then(|pair| pair.by_corners(semantic, (self.judge.moved, room)));
            let Some(found) = found.filter(|found| found.compared > 0) else { continue };
            if found.different == 0 && found.missing == 0 {
                claims.prove(claim);
                return Ok(());
            }
            is_partial |= found.missing > 0;
            matched = matched.or(Some(found).filter(|found| found.different > 0));
        }
        // 2. The same values at the nearest places, or roughly so.
        let (mut least, mut is_like): (Option<f64>, bool) = (None, false);
        for pair in &self.pairs {
            let Some(found) = pair.facts_of(self.judge, semantic)? else { continue };
            let is_same = found.largest.is_some_and(|largest| largest <= room);
            if is_same && matched.is_none() && !is_partial {
                claims.prove(claim);
                return Ok(());
            }
            let off = found.rms.unwrap_or(f64::INFINITY);
            least = Some(least.map_or(off, |least| lesser(off, least)));
            if let Some(both) = pair.pair()? {
                is_like |= is_roughly(semantic, off, both.boxes(semantic), room);
            }
        }
        // 3. Normals that the certificate says were computed, and those that nothing compares.
        if *semantic == Semantic::Normal {
            let how = said_normals(self.judge.certificate);
            if how.is_some() || matched.is_none() && (least.is_none() || is_partial) {
                return self.check_normals(claim, how, claims);
            }
        }
        // 4. What is like it where triangles are others, and what formats keep in forms of their own.
        let is_free = matches!(semantic, Semantic::Custom(_) | Semantic::Blended(_) | Semantic::Tangent);
        if is_free || is_like && (matched.is_none() || self.may_change()) {
            claims.pass(claim);
            return Ok(());
        }
        let (reason, is_most) = match (matched, least) {
            (Some(CornerDifferences { compared, different, .. }), _) => {
                let reason =
                    format!("{different} of {compared} corners have other values than in what was read");
                (reason, 2 * different > compared)
            }
            (None, Some(off)) => {
                let is_turned = is_direction(semantic) && off > TURNED_OVER_DEG;
                (format!("it is off by {off:?} from what was read, and nothing says so"), is_turned)
            }
            (None, None) => ("nothing compares it with that of what was read".to_owned(), false),
        };
        if is_most {
            claims.refute(claim, reason)
        } else {
            claims.open(claim, reason)
        }
        Ok(())
    }

    /// Whether the step may have changed what triangles carry that stayed.
    fn may_change(&self) -> bool {
        let mended = self.judge.certificate.get("mended").and_then(Value::as_array);
        let is_posed = self.pairs.iter().any(|pair| pair.form.is_unplaced);
        mended.is_some_and(|all| !all.is_empty()) || is_posed || self.judge.verb == "lod"
    }

    /// An attribute of triangles that were made of another shape.
    fn check_made(
        &self,
        claim: &str,
        semantic: &Semantic,
        claims: &mut ClaimList,
    ) -> Result<(), MeshFailure> {
        let polygons = match &self.judge.read.shape {
            Shape::Cage(polygons) => Some(polygons),
            _ => None,
        };
        let texcoords = polygons.and_then(|polygons| polygons.cage.texcoords());
        match semantic {
            Semantic::Normal => return self.check_normals(claim, None, claims),
            Semantic::TexCoord(_) if texcoords.is_some() => {
                let rows = texcoords.into_iter().flat_map(|own| own.values.iter().map(|row| &row[..]));
                let values = self.written.parts.iter().filter_map(|part| part.mesh.attribute(semantic));
                let found = ValueBox::of_rows(values.flat_map(|own| own.values.chunks(own.width.max(1))));
                let room = self.room(semantic)?;
                let may_be = |mut own: ValueBox| {
                    // Either way up: v of a picture begins at the bottom or at the top.
                    let is_like = |found: &ValueBox| found.may_be_of(&own, room);
                    let is_plain = found.as_ref().is_some_and(is_like);
                    (own.min[1], own.max[1]) = (1.0 - own.max[1], 1.0 - own.min[1]);
                    is_plain || found.as_ref().is_some_and(|found| found.may_be_of(&own, room))
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
                claims.open(claim, "the file has it, and what was read has nothing of the kind");
            }
            _ => claims.pass(claim),
        }
        Ok(())
    }

    /// Normals that were computed: how the certificate says, or for triangles without any as is usual; and else those of
    /// the shape, which look to the front.
    fn check_normals(
        &self,
        claim: &str,
        how: Option<Normals>,
        claims: &mut ClaimList,
    ) -> Result<(), MeshFailure> {
        /// The share of the area whose normals may look to the back: those of noisy samples do. Chosen.
        const SOME: f64 = 0.25;
        /// More than that is turned over.
        const MOST: f64 = 0.5;
        let how = how.or_else(|| said_normals(self.judge.certificate));
        let how = how.or_else(|| (!self.pairs.is_empty()).then_some(Normals::USUAL));
        if let Some(how) = how
            && are_computed(self.written, how, self.room(&Semantic::Normal)?)?
        {
            claims.prove(claim);
            return Ok(());
        }
        let share = share_backwards(self.written);
        let reason = format!("{:.0} % of the area has normals that look to the back", 100.0 * share);
        if share > MOST {
            claims.refute(claim, reason);
        } else if share > SOME {
            claims.open(claim, reason);
        } else {
            claims.pass(claim);
        }
        Ok(())
    }

    /// How far formats may round values: degrees for directions.
    fn room(&self, semantic: &Semantic) -> Result<f64, MeshFailure> {
        /// Of single precision, with room for a product of matrices. Chosen.
        const DIRECTION_DEG: f64 = 0.01;
        /// Of eight bits, as glTF may store them: 0.391° and the above.
        const SHORT_DIRECTION_DEG: f64 = 0.401;
        /// The share of the largest value that single precision, or six digits, leave open. Chosen.
        const SHARE: f64 = 2e-6;
        /// Two steps of eight bits.
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

/// Whether values that are off by so much in the mean are roughly those that were read.
fn is_roughly(semantic: &Semantic, rms: f64, [was, is]: [Option<ValueBox>; 2], room: f64) -> bool {
    /// Directions of coarse levels are some tens of degrees off. Chosen.
    const TURNED_DEG: f64 = 60.0;
    /// The share of the range of values. Chosen: the same value everywhere is 0.29 off where all are as frequent.
    const SHARE: f64 = 0.25;
    if is_direction(semantic) {
        return rms <= TURNED_DEG;
    }
    let Some((was, is)) = was.zip(is) else { return false };
    rms <= SHARE * was.diagonal() + room && is.may_be_of(&was, room)
}

/// A figure that is claimed, beside the one that was measured; `None` is what is no number.
fn compare(said: Option<f64>, found: Option<f64>, room: f64) -> FigureMatch {
    /// The share by which rounded values may differ. Chosen.
    const SAME: f64 = 1e-3;
    /// Of places that are as near another may be taken, whose value differs more. Chosen.
    const NEAR: f64 = 1.25;
    match (said, found) {
        (None, None) => FigureMatch::Same,
        (None, Some(_)) => FigureMatch::Unclear,
        (Some(_), None) => FigureMatch::Wrong,
        (Some(said), Some(found)) => {
            let is_same = (said - found).abs() <= room + SAME * greater(said, found);
            let is_near = found <= NEAR * said + room;
            match (is_same, is_near) {
                (true, _) => FigureMatch::Same,
                (_, true) => FigureMatch::Unclear,
                _ => FigureMatch::Wrong,
            }
        }
    }
}

/// What the claim about an attribute is called.
fn claim_of(semantic: &Semantic) -> String {
    format!("attributes/{}", AttributeFacts::names_of(semantic).1)
}

/// The attributes of a scene, but groups: names and materials are no part of what is looked at.
fn semantics_of(scene: &Scene) -> Vec<Semantic> {
    let mut found: Vec<Semantic> = Vec::new();
    for attribute in scene.parts.iter().flat_map(|part| part.mesh.attributes()) {
        let is_group = matches!(attribute.semantic, Semantic::Group(_));
        if !is_group && !found.contains(&attribute.semantic) {
            found.push(attribute.semantic.clone());
        }
    }
    found
}
