//! Rules for animations.
use super::GltfLint;
use super::buffers::{AccessorConstraint, AccessorUse, BufferViewUse, UseTable};
use super::extensions::ExtensionHost;
use crate::glb::format::{AccessorFormat, AccessorType, ComponentType};
use crate::glb::json::JsonValue;
use crate::glb::model::{
    GltfAnimation, GltfAnimationSampler, GltfChannel, GltfChannelTarget, GltfModel, GltfNode, item,
};
use std::collections::BTreeMap;

const TIMES: AccessorFormat = AccessorFormat::plain(AccessorType::Scalar, ComponentType::F32);

impl<'a> GltfLint<'a> {
    pub(super) fn animation(&mut self, map: &'a JsonValue) -> GltfAnimation<'a> {
        let channels = self.objects(map, "channels").map(|items| {
            let one = |lint: &mut Self, item| lint.channel(item);
            self.all_of("channels", items, one)
        });
        let samplers = self.objects(map, "samplers").map(|items| {
            let one = |lint: &mut Self, item| lint.animation_sampler(item);
            self.all_of("samplers", items, one)
        });
        self.name(map);
        self.extensions(map, ExtensionHost::Other);
        GltfAnimation { channels, samplers }
    }

    fn all_of<T>(
        &mut self,
        list: &'static str,
        items: &'a [JsonValue],
        look: impl Fn(&mut Self, &'a JsonValue) -> T,
    ) -> Vec<T> {
        self.within(list, |lint| {
            items.iter().enumerate().map(|(i, item)| lint.within(i, |lint| look(lint, item))).collect()
        })
    }

    fn channel(&mut self, map: &'a JsonValue) -> GltfChannel<'a> {
        let sampler = self.index(map, "sampler", true);
        let target = self.object(map, "target", true);
        let target = target.map(|target| self.within("target", |lint| lint.target(target)));
        self.extensions(map, ExtensionHost::Other);
        GltfChannel { sampler, target }
    }

    fn target(&mut self, map: &'a JsonValue) -> GltfChannelTarget<'a> {
        let node = self.index(map, "node", false);
        let path = self.text(map, "path", true);
        let extensions = self.extensions(map, ExtensionHost::ChannelTarget);
        self.each_extension(extensions, |lint, _, value| {
            if let Some(text) = lint.text(value, "pointer", true)
                && !is_pointer(text)
            {
                lint.issue_below("PATTERN_MISMATCH", "pointer", "the text is no JSON pointer");
            }
            if node.is_some_and(|node| lint.exists("nodes", node)) {
                let what = "the target has a node beside its pointer";
                lint.issue_here("KHR_ANIMATION_POINTER_ANIMATION_CHANNEL_TARGET_NODE", what);
            }
            if path != Some("pointer") {
                let what = "the target's path is not \"pointer\"";
                lint.issue_here("KHR_ANIMATION_POINTER_ANIMATION_CHANNEL_TARGET_PATH", what);
            }
        });
        GltfChannelTarget { node, path }
    }

    fn animation_sampler(&mut self, map: &'a JsonValue) -> GltfAnimationSampler<'a> {
        let input = self.index(map, "input", true);
        let interpolation = self.text(map, "interpolation", false).unwrap_or("LINEAR");
        let output = self.index(map, "output", true);
        self.extensions(map, ExtensionHost::Other);
        GltfAnimationSampler { input, output, interpolation }
    }

    pub(super) fn link_animations(&mut self, model: &GltfModel<'a>, uses: &mut UseTable) {
        for (i, animation) in model.animations.iter().enumerate() {
            let Some(GltfAnimation { channels: Some(channels), samplers: Some(samplers) }) = animation else {
                continue;
            };
            self.within_path(&["animations".into(), i.into()], |lint| {
                for (s, sampler) in samplers.iter().enumerate() {
                    lint.within_path(&["samplers".into(), s.into()], |lint| {
                        lint.link_sampler(model, sampler, uses)
                    });
                }
                let mut last = BTreeMap::new();
                let mut twins = Vec::new();
                for (c, channel) in channels.iter().enumerate() {
                    lint.within_path(&["channels".into(), c.into()], |lint| {
                        if let Some(target) = &channel.target {
                            lint.within("target", |lint| lint.link_target(model, target));
                            let key = target.node.map(|node| (node, target.path));
                            twins.extend(key.and_then(|key| last.insert(key, c)).map(|other| (other, c)));
                        }
                        lint.link_channel(model, samplers, channel, uses);
                    });
                }
                for (first, second) in twins {
                    lint.within_path(&["channels".into(), first.into()], |lint| {
                        let what = format!("channel {second} has the same target");
                        lint.issue("ANIMATION_DUPLICATE_TARGETS", Some("target".into()), || what);
                    });
                }
            });
        }
    }

    fn link_sampler(
        &mut self,
        model: &GltfModel<'a>,
        sampler: &GltfAnimationSampler<'a>,
        uses: &mut UseTable,
    ) {
        for (key, index, role) in
            [("input", sampler.input, AccessorUse::Input), ("output", sampler.output, AccessorUse::Output)]
        {
            let Some(index) = index else { continue };
            if !self.resolved("accessors", index, key.into()) {
                continue;
            }
            let Some(accessor) = item(&model.accessors, Some(index)) else { continue };
            self.use_accessor(uses, index, role, key);
            self.use_view(uses, accessor.view, BufferViewUse::Other, key);
            if item(&model.views, accessor.view).is_some_and(|view| view.stride.is_some()) {
                self.issue_below(
                    "ANIMATION_SAMPLER_ACCESSOR_WITH_BYTESTRIDE",
                    key,
                    "animations have no byteStride",
                );
            }
            if role == AccessorUse::Output {
                continue;
            }
            self.within(key, |lint| {
                if accessor.format() == Some(TIMES) {
                    uses.constrain(index, AccessorConstraint::Times, lint.pointer(None));
                } else {
                    lint.issue_here(
                        "ANIMATION_SAMPLER_INPUT_ACCESSOR_INVALID_FORMAT",
                        "times are single floats",
                    );
                }
                if accessor.min.is_none() || accessor.max.is_none() {
                    lint.issue_here(
                        "ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS",
                        "times need min and max",
                    );
                }
                if sampler.interpolation == "CUBICSPLINE" && accessor.count.is_some_and(|count| count < 2) {
                    let what = "a cubic spline needs two times";
                    lint.issue_here("ANIMATION_SAMPLER_INPUT_ACCESSOR_TOO_FEW_ELEMENTS", what);
                }
            });
        }
    }

    fn link_target(&mut self, model: &GltfModel<'a>, target: &GltfChannelTarget<'a>) {
        let Some(index) = target.node else { return };
        if !self.resolved("nodes", index, "node".into()) {
            return;
        }
        let Some(node) = item(&model.nodes, Some(index)) else { return };
        match target.path {
            Some("translation" | "rotation" | "scale") if node.matrix().is_some() => {
                self.issue_here(
                    "ANIMATION_CHANNEL_TARGET_NODE_MATRIX",
                    "the node has a matrix, which cannot move",
                );
            }
            Some("weights") if n_targets(model, node).is_none() => {
                let what = "the node's mesh has no morph targets";
                self.issue_here("ANIMATION_CHANNEL_TARGET_NODE_WEIGHTS_NO_MORPHS", what);
            }
            _ => {}
        }
    }

    fn link_channel(
        &mut self,
        model: &GltfModel<'a>,
        samplers: &[GltfAnimationSampler<'a>],
        channel: &GltfChannel<'a>,
        uses: &mut UseTable,
    ) {
        let Some(index) = channel.sampler else { return };
        let Some(sampler) = samplers.get(index) else {
            self.issue("UNRESOLVED_REFERENCE", Some("sampler".into()), || {
                format!("there is no sampler {index}")
            });
            return;
        };
        let Some(target) = &channel.target else { return };
        let (Some(output), Some(path)) = (sampler.output, target.path) else { return };
        let Some(accessor) = item(&model.accessors, Some(output)) else { return };
        let cubic = sampler.interpolation == "CUBICSPLINE";
        if path == "rotation" && accessor.kind.is_some_and(|kind| kind.n_components() == 4) {
            uses.constrain(
                output,
                AccessorConstraint::Quaternions { cubic },
                self.pointer(Some("sampler".into())),
            );
        }
        let is_known = ["translation", "rotation", "scale", "weights"].contains(&path);
        if is_known && !accessor.format().is_some_and(|format| moves(path, format)) {
            self.issue("ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_FORMAT", Some("sampler".into()), || {
                format!("the output's format is not for {path}")
            });
        }
        let times = item(&model.accessors, sampler.input).and_then(|input| input.count);
        let (Some(times), Some(count), true) = (times, accessor.count, is_known) else { return };
        let per_time = match path {
            "weights" => {
                item(&model.nodes, target.node).and_then(|node| n_targets(model, node)).unwrap_or(0) as u64
            }
            _ => 1,
        };
        // A value of a cubic spline stands between two tangents. 0 if the number of targets is not
        // known.
        let expected = times.saturating_mul(if cubic { 3 } else { 1 }).saturating_mul(per_time);
        if expected != 0 && expected != count {
            let what = format!("{expected} outputs are needed, the accessor has {count}");
            self.issue("ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_COUNT", Some("sampler".into()), || what);
        }
    }
}

fn n_targets(model: &GltfModel<'_>, node: &GltfNode<'_>) -> Option<usize> {
    Some(item(&model.meshes, node.mesh)?.primitives.first()?.targets.as_ref()?.len())
}

/// Whether values of this format can animate a property.
fn moves(path: &str, format: AccessorFormat) -> bool {
    let kind = match path {
        "rotation" => AccessorType::Vec4,
        "weights" => AccessorType::Scalar,
        _ => return format == AccessorFormat::plain(AccessorType::Vec3, ComponentType::F32),
    };
    format.kind == kind
        && match format.component {
            ComponentType::F32 => !format.normalized,
            ComponentType::U32 => false,
            _ => format.normalized,
        }
}

/// Whether a text is a JSON pointer: empty, or a sequence of steps in which `~` is escaped.
fn is_pointer(text: &str) -> bool {
    let mut tildes = text.split('~').skip(1);
    (text.is_empty() || text.starts_with('/')) && tildes.all(|after| after.starts_with(['0', '1']))
}
