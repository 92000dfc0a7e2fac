//! The claims of the coarser levels of detail in a glTF, and of levels of parts that are in no level of the scene.
use super::claims::ClaimList;
use super::steps::{GivenFile, HISTORY, ProvedSteps};
use super::{CertifiedFile, check_file, history, n_coarser_levels};
use crate::provenance::geometry_digest::digest_in_frame;
use crate::provenance::origin::{embedded_certificate, stated_frame};
use crate::report::HistoryFacts;
use crate::scene::placements::n_places;
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
    // In a file with several placements, a level of the scene combines levels of the parts.
    let is_single = matches!(&finest.shape, Shape::Scene(scene) if n_places(scene) == 1);
    let mut is_matched = vec![false; coarser.len()];
    let certificates: Vec<&Value> =
        coarser.iter().filter_map(|level| embedded_certificate(&level.shape)).collect();
    for (k, certificate) in certificates.iter().enumerate() {
        let name = format!("levels/{}", k + 1);
        let stated =
            history(certificate).ok().and_then(|history| history.steps.last()?.output.geometry.clone());
        let mut matching = None;
        for (at, level) in coarser.iter().enumerate() {
            if stated.is_some() && digest_of(level, certificate)? == stated {
                // Levels with the same geometry are all accounted for, and the first one stands for them.
                matching = matching.or(Some((at, level)));
                is_matched[at] = true;
            }
        }
        match matching {
            Some((_, file)) => {
                let mut level_claims = ClaimList::default();
                check_file(&CertifiedFile { file, certificate, against }, &mut level_claims, job)?;
                claims.extend_as(&name, level_claims);
            }
            None if is_single => claims.refute(
                &format!("{name}/geometry"),
                "the file holds another geometry than in the certificate of this level",
            ),
            None => claims.open(
                &name,
                "the certificate does not state which levels of the parts form this level of the scene",
            ),
        }
    }
    let unmatched = coarser.iter().zip(&is_matched).enumerate().filter(|(_, (_, is_matched))| !**is_matched);
    for (at, (level, _)) in unmatched {
        let name = format!("levels/in the file {}", at + 1);
        match certificates.last() {
            Some(coarsest) if is_single => {
                let mut level_claims = ClaimList::default();
                check_unclaimed(level, coarsest, (against, job), &mut level_claims)?;
                claims.extend_as(&name, level_claims);
            }
            _ => claims.open(&name, "no certificate is for this level"),
        }
    }
    Ok(())
}

fn digest_of(level: &Input, certificate: &Value) -> Result<Option<String>, MeshFailure> {
    Ok(digest_in_frame(&level.shape, level.format, &stated_frame(certificate))?)
}

/// A level without a certificate must be no farther from the input than the coarsest level with one.
fn check_unclaimed(
    level: &Input,
    coarsest: &Value,
    (against, job): (&[GivenFile<'_>], &Job),
    claims: &mut ClaimList,
) -> Result<(), MeshFailure> {
    let HistoryFacts { begins, mut steps, .. } = match history(coarsest) {
        Ok(history) => history,
        Err(reason) => {
            claims.open("history", reason);
            return Ok(());
        }
    };
    if let Some(last) = steps.last_mut() {
        last.output.geometry = digest_of(level, coarsest)?;
        // The level may be nearer to the input than the coarsest one with a certificate.
        last.bound.iter_mut().for_each(|bound| bound.at_least = 0.0);
    }
    let history = &HistoryFacts::new(begins, steps);
    let frame = stated_frame(coarsest);
    let (certificate, witness) = (Some(coarsest), None);
    ProvedSteps { name: HISTORY, out: level, frame, certificate, baked: None, witness, history, against, job }
        .check(claims)
}
