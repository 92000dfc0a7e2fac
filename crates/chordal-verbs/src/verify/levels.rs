//! The coarser levels of detail in a glTF: what each claims, and those of parts that are in no level of the whole.
use super::claims::ClaimList;
use super::steps::{GivenFile, HISTORY, ProvedSteps};
use super::{CertifiedFile, check_file, history, n_coarser_levels};
use crate::geometry_digest::digest_in_frame;
use crate::origin::{embedded_certificate, stated_frame};
use crate::placements::n_places;
use crate::report::HistoryFacts;
use crate::{Input, MeshFailure, Shape};
use chordal::Job;
use serde_json::Value;

/// Checks all levels but the finest.
pub(super) fn check(
    (finest, coarser): (&Input, &[Input]),
    against: &[GivenFile<'_>],
    claims: &mut ClaimList,
    job: &Job,
) -> Result<(), MeshFailure> {
    let n = n_coarser_levels(finest);
    if coarser.len() < n {
        claims.open("levels", format!("{n} coarser levels are in the file, and were not looked at"));
        return Ok(());
    }
    // A file that shows several places has combinations of their levels.
    let is_one = matches!(&finest.shape, Shape::Scene(scene) if n_places(scene) == 1);
    let mut is_known = vec![false; coarser.len()];
    let certificates: Vec<&Value> =
        coarser.iter().filter_map(|level| embedded_certificate(&level.shape)).collect();
    for (k, certificate) in certificates.iter().enumerate() {
        let name = format!("levels/{}", k + 1);
        let said =
            history(certificate).ok().and_then(|history| history.steps.last()?.output.geometry.clone());
        let mut found = None;
        for (at, level) in coarser.iter().enumerate() {
            if said.is_some() && digest_of(level, certificate)? == said {
                found = found.or(Some((at, level)));
                is_known[at] = true;
            }
        }
        match found {
            Some((_, file)) => {
                let mut own = ClaimList::default();
                check_file(&CertifiedFile { file, certificate, against }, &mut own, job)?;
                claims.extend_as(&name, own);
            }
            None if is_one => claims.refute(
                &format!("{name}/geometry"),
                "the file holds another geometry than the certificate of this level speaks of",
            ),
            None => claims.open(&name, "which levels of the parts make this level of the whole is not said"),
        }
    }
    let rest = coarser.iter().zip(&is_known).enumerate().filter(|(_, (_, is_known))| !**is_known);
    for (at, (level, _)) in rest {
        let name = format!("levels/in the file {}", at + 1);
        match certificates.last() {
            Some(coarsest) if is_one => {
                let mut own = ClaimList::default();
                check_unclaimed(level, coarsest, (against, job), &mut own)?;
                claims.extend_as(&name, own);
            }
            _ => claims.open(&name, "no certificate speaks of this level"),
        }
    }
    Ok(())
}

fn digest_of(level: &Input, certificate: &Value) -> Result<Option<String>, MeshFailure> {
    Ok(digest_in_frame(&level.shape, level.format, &stated_frame(certificate))?)
}

/// A level that no certificate speaks of is no farther from the input than the coarsest that one speaks of.
fn check_unclaimed(
    level: &Input,
    coarsest: &Value,
    (against, job): (&[GivenFile<'_>], &Job),
    claims: &mut ClaimList,
) -> Result<(), MeshFailure> {
    let HistoryFacts { begins, mut steps, .. } = match history(coarsest) {
        Ok(history) => history,
        Err(why) => {
            claims.open("history", why);
            return Ok(());
        }
    };
    if let Some(last) = steps.last_mut() {
        last.output.geometry = digest_of(level, coarsest)?;
        // It may be nearer.
        last.bound.iter_mut().for_each(|bound| bound.at_least = 0.0);
    }
    let history = &HistoryFacts::new(begins, steps);
    let frame = stated_frame(coarsest);
    let (certificate, witness) = (Some(coarsest), None);
    ProvedSteps { name: HISTORY, out: level, frame, certificate, baked: None, witness, history, against, job }
        .check(claims)
}
