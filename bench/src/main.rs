//! All programs of the bench in one, which runs the one that it is called by: the Makefile links it under each name. The library
//! and the peers are linked once, which takes minutes with optimisation across crates.
use std::process::ExitCode;

mod programs {
    pub mod baking;
    pub mod booleans;
    pub mod curves;
    pub mod field_meshes;
    pub mod fields;
    pub mod file_speed;
    pub mod limit_meshes;
    pub mod measure;
    pub mod meshes;
    pub mod nurbs;
    pub mod patches;
    pub mod polygons;
    pub mod rays;
    pub mod simplify;
    pub mod subdivision;
    pub mod volumes;
}

fn main() -> ExitCode {
    use programs::{
        baking, booleans, curves, field_meshes, fields, file_speed, limit_meshes, measure, meshes, nurbs, patches,
        polygons, rays, simplify, subdivision, volumes,
    };
    let called = std::env::args().next().unwrap_or_default();
    let name = std::path::Path::new(&called).file_stem().and_then(|name| name.to_str()).unwrap_or_default();
    let written = |result: std::io::Result<()>| result.expect("standard output takes what is written");
    match name {
        "baking" => baking::main(),
        "booleans" => booleans::main(),
        "curves" => curves::main(),
        "field_meshes" => field_meshes::main(),
        "fields" => fields::main(),
        "file_speed" => file_speed::main(),
        "limit_meshes" => limit_meshes::main(),
        "measure" => measure::main(),
        "meshes" => meshes::main(),
        "nurbs" => written(nurbs::main()),
        "patches" => written(patches::main()),
        "polygons" => polygons::main(),
        "rays" => rays::main(),
        "simplify" => simplify::main(),
        "subdivision" => subdivision::main(),
        "volumes" => volumes::main(),
        _ => {
            eprintln!("'{name}' is no program of the bench: call one by its name, as 'make -C bench programs' links them");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}
