//! The plan of a batch: the output of every input.
use super::inputs::{BatchFile, BatchInputs};
use super::verb::BatchVerb;
use crate::fault::Fault;
use chordal_verbs::extension;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// One file of a batch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BatchItem {
    /// The input.
    pub file: BatchFile,
    /// The relative path of the input, joined by `/` as in the manifest.
    pub input_name: String,
    /// The path of the output below the output folder.
    pub output: PathBuf,
    /// The same joined by `/`.
    pub output_name: String,
    /// The extension of the output.
    pub extension: String,
}

/// How outputs are named.
#[derive(Clone, Debug)]
pub struct OutputNaming {
    /// The extension of `--to`, if given.
    pub to: Option<String>,
    /// Whether the extension of the input stays in the name.
    pub keeps_extension: bool,
}

/// The items of a batch, ordered by input name.
///
/// # Errors
/// If two inputs have the same output.
pub fn plan(inputs: BatchInputs, verb: BatchVerb, naming: &OutputNaming) -> Result<Vec<BatchItem>, Fault> {
    let mut items: Vec<BatchItem> = Vec::new();
    let mut taken: BTreeMap<PathBuf, PathBuf> = BTreeMap::new();
    for file in inputs.files {
        let extension = match &naming.to {
            Some(extension) => extension.clone(),
            None => verb.usual_extension(&file.path),
        };
        let output = output_of(&file.relative, &extension, naming.keeps_extension);
        // Before the work: with several at once, it would be chance which of the two stays.
        if let Some(other) = taken.insert(output.clone(), file.path.clone()) {
            let pair = format!("{} and {}", other.display(), file.path.display());
            let advice = if naming.keeps_extension || extension_of(&other) == extension_of(&file.path) {
                "set --base to a folder that contains both"
            } else {
                "--keep-extension gives them different names"
            };
            return Err(Fault::usage(format!(
                "{pair} would both be written as {}: {advice}",
                output.display()
            )));
        }
        let (input_name, output_name) = (joined(&file.relative), joined(&output));
        items.push(BatchItem { file, input_name, output, output_name, extension });
    }
    items.sort_by(|a, b| a.input_name.cmp(&b.input_name));
    Ok(items)
}

fn extension_of(path: &Path) -> String {
    extension(&path.to_string_lossy()).unwrap_or_default().to_owned()
}

/// `a/b.obj` as `a/b.glb`, or as `a/b.obj.glb`.
fn output_of(relative: &Path, to: &str, keeps_extension: bool) -> PathBuf {
    // For all files alike, so that a name does not depend on which others there are.
    let extension = extension_of(relative);
    let name = relative.file_name().unwrap_or_default();
    let mut output = name.to_owned();
    // A name that is not Unicode keeps its extension, since its bytes cannot be split safely.
    if let Some(stem) = name.to_str().filter(|_| !keeps_extension && !extension.is_empty()) {
        output = stem[..stem.len() - extension.len() - 1].into();
    }
    output.push(".");
    output.push(to);
    relative.with_file_name(output)
}

fn joined(path: &Path) -> String {
    let names = path.components().filter_map(|part| match part {
        Component::Normal(name) => Some(name.to_string_lossy()),
        _ => None,
    });
    names.collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planned(names: &[&str], keeps_extension: bool) -> Result<Vec<String>, Fault> {
        let file = |name: &&str| BatchFile { relative: (*name).into(), path: (*name).into() };
        let inputs = BatchInputs { files: names.iter().map(file).collect(), left_out: 0 };
        let naming = OutputNaming { to: Some("glb".to_owned()), keeps_extension };
        let items = plan(inputs, BatchVerb::Mesh, &naming)?;
        Ok(items.into_iter().map(|item| item.output_name).collect())
    }

    #[test]
    fn outputs_have_the_name_of_the_input_and_the_new_extension() {
        let outputs = planned(&["a/b.c.obj", "brain.nii.gz", "teaset", "é ü.stl"], false);
        assert_eq!(outputs.unwrap(), ["a/b.c.glb", "brain.glb", "teaset.glb", "é ü.glb"]);
        assert_eq!(planned(&["a.obj", "a.stl"], true).unwrap(), ["a.obj.glb", "a.stl.glb"]);
    }

    #[test]
    fn two_inputs_of_one_output_are_refused_by_name() {
        let refused = planned(&["x/a.obj", "x/a.stl"], false).unwrap_err();
        for part in ["x/a.obj and x/a.stl", "x/a.glb", "--keep-extension"] {
            assert!(refused.lines[0].contains(part), "{refused:?}");
        }
    }
}
