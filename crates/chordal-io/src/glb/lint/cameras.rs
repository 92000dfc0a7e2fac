//! Rules for cameras and texture samplers, which no other rules refer to.
use super::extensions::ExtensionHost;
use super::{GltfLint, IntegerRule, NumberRule};
use crate::glb::json::JsonValue;

impl<'a> GltfLint<'a> {
    pub(super) fn camera(&mut self, camera: &'a JsonValue) {
        if camera.get("orthographic").is_some() && camera.get("perspective").is_some() {
            self.issue_here("ONE_OF_MISMATCH", "a camera is either orthographic or perspective");
        }
        match self.text(camera, "type", true) {
            Some("orthographic") => {
                if let Some(map) = self.object(camera, "orthographic", true) {
                    self.within("orthographic", |lint| lint.orthographic(map));
                }
            }
            Some("perspective") => {
                if let Some(map) = self.object(camera, "perspective", true) {
                    self.within("perspective", |lint| lint.perspective(map));
                }
            }
            _ => {}
        }
        self.name(camera);
        self.extensions(camera, ExtensionHost::Other);
    }

    fn orthographic(&mut self, map: &'a JsonValue) {
        for key in ["xmag", "ymag"] {
            if self.number(map, key, NumberRule::ANY.required()).value() == Some(0.0) {
                self.issue_below("CAMERA_XMAG_YMAG_ZERO", key, "a magnification of zero");
            }
        }
        let far = self.number(map, "zfar", NumberRule::ABOVE_0.required()).value();
        let near = self.number(map, "znear", NumberRule::AT_LEAST_0.required()).value();
        self.depth(near, far);
        self.extensions(map, ExtensionHost::Other);
    }

    fn perspective(&mut self, map: &'a JsonValue) {
        self.number(map, "yfov", NumberRule::ABOVE_0.required());
        let far = self.number(map, "zfar", NumberRule::ABOVE_0).value();
        let near = self.number(map, "znear", NumberRule::ABOVE_0.required()).value();
        self.depth(near, far);
        self.number(map, "aspectRatio", NumberRule::ABOVE_0);
        self.extensions(map, ExtensionHost::Other);
    }

    fn depth(&mut self, near: Option<f64>, far: Option<f64>) {
        if let (Some(near), Some(far)) = (near, far)
            && far <= near
        {
            self.issue("CAMERA_ZFAR_LEQUAL_ZNEAR", None, || format!("zfar {far} is not above znear {near}"));
        }
    }

    pub(super) fn sampler(&mut self, sampler: &'a JsonValue) {
        // The validator does not treat values outside the lists as errors, only wrong types.
        const NAMED: IntegerRule = IntegerRule { min: 0, max: None, list: &[0], required: false };
        for key in ["magFilter", "minFilter", "wrapS", "wrapT"] {
            self.integer(sampler, key, NAMED);
        }
        self.name(sampler);
        self.extensions(sampler, ExtensionHost::Other);
    }
}
