//! Preview surfaces become materials of glTF, with their pictures.
use super::{codes, file, scene, triangle};
use chordal::explicit::Semantic;
use chordal_io::{Content, Format, Limits, MATERIAL, read_with};
use serde_json::json;

fn material(inputs: &str, more: &str) -> String {
    format!(
        "def Material \"M\" {{ token outputs:surface.connect = </M/S.outputs:surface>
        def Shader \"S\" {{ uniform token info:id = \"UsdPreviewSurface\" {inputs} token outputs:surface }} {more} }}"
    )
}

fn bound(name: &str) -> String {
    triangle(name).replace("{ uniform", "{ rel material:binding = </M>\n uniform")
}

#[test]
fn inputs_are_those_of_gltf_or_what_the_specification_says() {
    let plain = scene(&file(&(bound("m") + &material("", ""))));
    let expected = json!({ "name": "M", "pbrMetallicRoughness": { "baseColorFactor": [0.18, 0.18, 0.18, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.5 } });
    assert_eq!(plain.assets.materials, [expected]);
    let inputs = "color3f inputs:diffuseColor = (0.5, 0.25, 1) float inputs:metallic = 0.75 float inputs:roughness = 0.125
        float inputs:opacity = 0.5 color3f inputs:emissiveColor = (2, 1, 0) float inputs:clearcoat = 1 float inputs:ior = 1.25 int inputs:useSpecularWorkflow = 1";
    let text = file(&(bound("m") + &material(inputs, "")));
    let found = &scene(&text).assets.materials[0];
    assert_eq!(found["pbrMetallicRoughness"]["baseColorFactor"], json!([0.5, 0.25, 1.0, 0.5]));
    assert_eq!((&found["alphaMode"], &found["emissiveFactor"]), (&json!("BLEND"), &json!([1.0, 0.5, 0.0])));
    assert_eq!(found["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 2.0);
    assert_eq!(found["extensions"]["KHR_materials_ior"]["ior"], 1.25);
    assert_eq!(found["extensions"]["KHR_materials_clearcoat"]["clearcoatRoughnessFactor"], 0.01);
    assert_eq!(codes(&text), ["inputs-skipped"]);
}

#[test]
fn materials_are_inherited_and_subsets_have_their_own() {
    let quad = "uniform token subdivisionScheme = \"none\" point3f[] points = [(0,0,0),(1,0,0),(1,1,0),(0,1,0)]
        int[] faceVertexCounts = [3, 3] int[] faceVertexIndices = [0, 1, 2, 0, 2, 3]
        def GeomSubset \"s\" { uniform token familyName = \"materialBind\" int[] indices = [1] rel material:binding = </N> }
        def GeomSubset \"t\" { uniform token familyName = \"g\" int[] indices = [0] }";
    let other = material("", "").replace("\"M\"", "\"N\"").replace("/M/", "/N/");
    let text = file(&format!(
        "def Xform \"x\" {{ rel material:binding = </M> def Mesh \"q\" {{ {quad} }} }} {} {other}",
        material("", "")
    ));
    let scene = scene(&text);
    let group =
        |kind: &str| scene.parts[0].mesh.attribute(&Semantic::Group(kind.to_owned())).unwrap().values.clone();
    assert_eq!((group(MATERIAL), group("g")), (vec![1.0, 2.0], vec![1.0, 0.0]));
    assert_eq!(
        (&scene.groups[MATERIAL][1..], &scene.groups["g"][1..]),
        (&["M".to_owned(), "N".to_owned()][..], &["t".to_owned()][..])
    );
}

/// The first bytes of a PNG are enough for what only carries it.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n0123456789";

#[test]
fn pictures_are_taken_from_beside_with_their_place() {
    let texture = |name: &str, file: &str| {
        format!(
        "def Shader \"{name}\" {{ uniform token info:id = \"UsdUVTexture\" asset inputs:file = @{file}@ token inputs:wrapS = \"mirror\"
        float2 inputs:st.connect = </M/T.outputs:result> float4 inputs:scale = (0.5, 0.25, 1, 1) float3 outputs:rgb }}"
    )
    };
    let more = texture("C", "./tex/a.png") + &texture("R", "b.png")
        + "def Shader \"T\" { uniform token info:id = \"UsdTransform2d\" float2 inputs:in.connect = </M/P.outputs:result> float2 inputs:scale = (2, 4) float2 inputs:translation = (0.5, 0.25) }
        def Shader \"P\" { uniform token info:id = \"UsdPrimvarReader_float2\" string inputs:varname = \"map\" }";
    let inputs = "color3f inputs:diffuseColor.connect = </M/C.outputs:rgb> float inputs:roughness.connect = </M/R.outputs:g>";
    let mesh = bound("m").replace(
        "int[] faceVertexCounts",
        "texCoord2f[] primvars:a = [(9,9),(9,9),(9,9)] (interpolation = \"vertex\")
        texCoord2f[] primvars:map = [(0,0),(1,0),(0,1)] (interpolation = \"vertex\") int[] faceVertexCounts",
    );
    let text = file(&(mesh + &material(inputs, &more)));
    let mut asked = Vec::new();
    let mut open = |path: &str| {
        asked.push(path.to_owned());
        if path == "tex/a.png" { Ok(PNG.to_vec()) } else { Err("gone".to_owned()) }
    };
    let outcome = read_with(text.as_bytes(), Format::Usda, &mut open, &Limits::default()).unwrap();
    let Content::Scene(scene) = outcome.content else { panic!("a scene") };
    assert_eq!(asked, ["tex/a.png", "b.png"]);
    let pbr = &scene.assets.materials[0]["pbrMetallicRoughness"];
    assert_eq!(pbr["baseColorFactor"], json!([0.5, 0.25, 1.0, 1.0]));
    assert_eq!(
        pbr["baseColorTexture"]["extensions"]["KHR_texture_transform"],
        json!({ "offset": [0.5, -3.25], "scale": [2.0, 4.0] })
    );
    assert_eq!(scene.assets.samplers, [json!({ "wrapS": 33648, "wrapT": 10497 })]);
    assert_eq!(outcome.warnings.iter().map(|w| w.code).collect::<Vec<_>>(), ["picture-missing"]);
    let st = scene.parts[0].mesh.attribute(&Semantic::TexCoord(0)).unwrap();
    assert_eq!(st.row(1), [1.0, 0.0], "the set that the material names comes first");
}

#[test]
fn surfaces_that_are_not_read_keep_their_names() {
    let odd = material("", "").replace("UsdPreviewSurface", "ND_standard_surface");
    let text = file(&(bound("m") + &odd));
    assert_eq!(scene(&text).assets.materials[0]["name"], "M");
    assert_eq!(codes(&text), ["materials-unread"]);
    assert_eq!(codes(&file(&bound("m"))), ["material-missing"]);
    let circle = "float inputs:roughness.connect = </M.inputs:a>";
    let more = "float inputs:a.connect = </M.inputs:a>";
    assert_eq!(scene(&file(&(bound("m") + &material(circle, more)))).assets.materials.len(), 1);
}
