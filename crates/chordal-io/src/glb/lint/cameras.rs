//! Cameras and texture samplers: objects that no other rule needs.
use super::extensions::At;
use super::{Lint, Real, Whole};
use crate::glb::json::Json;

impl<'a> Lint<'a> {
    pub(super) fn camera(&mut self, camera: &'a Json) {
        if camera.get("orthographic").is_some() && camera.get("perspective").is_some() {
            self.here("ONE_OF_MISMATCH", "a camera is either orthographic or perspective");
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
        self.extensions(camera, At::Other);
    }

    fn orthographic(&mut self, map: &'a Json) {
        for key in ["xmag", "ymag"] {
            if self.real(map, key, Real::ANY.required()).value() == Some(0.0) {
                self.at("CAMERA_XMAG_YMAG_ZERO", key, "a magnification of zero");
            }
        }
        let far = self.real(map, "zfar", Real::ABOVE_0.required()).value();
        let near = self.real(map, "znear", Real::AT_LEAST_0.required()).value();
        self.depth(near, far);
        self.extensions(map, At::Other);
    }

    fn perspective(&mut self, map: &'a Json) {
        self.real(map, "yfov", Real::ABOVE_0.required());
        let far = self.real(map, "zfar", Real::ABOVE_0).value();
        let near = self.real(map, "znear", Real::ABOVE_0.required()).value();
        self.depth(near, far);
        self.real(map, "aspectRatio", Real::ABOVE_0);
        self.extensions(map, At::Other);
    }

    fn depth(&mut self, near: Option<f64>, far: Option<f64>) {
        if let (Some(near), Some(far)) = (near, far)
            && far <= near
        {
            self.issue("CAMERA_ZFAR_LEQUAL_ZNEAR", None, || format!("zfar {far} is not above znear {near}"));
        }
    }

    pub(super) fn sampler(&mut self, sampler: &'a Json) {
        // Values outside the lists are no errors for the validator, wrong types are.
        const NAMED: Whole = Whole { min: 0, max: None, list: &[0], required: false };
        for key in ["magFilter", "minFilter", "wrapS", "wrapT"] {
            self.whole(sampler, key, NAMED);
        }
        self.name(sampler);
        self.extensions(sampler, At::Other);
    }
}
