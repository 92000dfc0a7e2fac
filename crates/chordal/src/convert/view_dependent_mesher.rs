//! `ViewDependentMesher`: meshes a surface for one view after another, and reuses the tiles that still hold.
use super::cage_to_mesh::CageMesher;
use super::patches::adjacency::PatchAdjacency;
use super::patches::allowance::{Allowance, TessellationFailure};
use super::patches::mesher::{CertifiedTiles, PatchMesher};
use super::patches::subpatch::PatchSurface;
use super::patches_to_mesh::checked_patches;
use crate::budget::{Bounded, Budget, Failure, Job, RefusalCode, Tolerance};
use crate::explicit::subdivision::Scheme;
use crate::explicit::{Mesh, Patch};

/// Meshes patches or a cage for one view after another, as for a moving camera.
///
/// It keeps the tiles of the last mesh: rectangles of the parameter plane, each with its triangles and the proof of its
/// distance. At the next view
/// - a tile *holds* if its distance is still within the allowed pixels,
/// - a patch (of a cage, a face) is planned anew if one of its tiles does not hold, or if fewer than half of its
///   triangles would suffice,
/// - tiles beside a changed tile are built and proved again if the vertices on their border change, and
/// - all others are reused.
///
/// Tiles are planned for three quarters of the allowed length, so that they still hold while the eye comes nearer: a
/// mesh has a third more triangles than one of [`patches_to_mesh`](super::patches_to_mesh()) or
/// [`cage_to_mesh`](super::cage_to_mesh()), and up to twice as many after the eye has moved away.
///
/// **Bound.** As for those, *proved* for the view of this mesh: lengths are proved once, and their pixels computed for
/// every view. Every mesh is free of cracks.
///
/// **Budgets.** Pixels at a view, a length, or both, which may change from mesh to mesh. A length is met in the same way
/// as pixels at a view.
///
/// **Cost.** That of the tiles that change, and one pass over all triangles for each mesh. Tiles are kept with their cells
/// and borders, which count towards the job's limits. The same sequence of budgets gives the same bytes, on any number of
/// threads. Limit surfaces of Loop's scheme are meshed anew for each view; none of their triangles are kept.
///
/// ```
/// use chordal::{Budget, Job, Patch, View, budget::Pixels, convert::batch::ViewDependentMesher};
/// let mut patch = Patch::flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
/// patch.control[1][1][2] = 1.0;
/// let mut mesher = ViewDependentMesher::from_patches(&[patch]).unwrap();
/// let mut made = 0;
/// for k in 0..10 {
///     let view: View = format!("640x480 fov=45 eye=4,{},2 target=0.5,0.5,0", 0.02 * f64::from(k)).parse()?;
///     let frame = mesher.mesh(&Budget::pixels(Pixels::new(1.0)?, view), &Job::default()).unwrap();
///     assert!(frame.bound.pixels.unwrap() <= 1.0);
///     made += mesher.reuse().made;
/// }
/// assert_eq!(made, mesher.reuse().kept); // all by the first view, and kept since
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Source: the reuse between frames is that of H. Hoppe, *View-dependent refinement of progressive meshes*, 1997; here
/// with proved tiles.
pub struct ViewDependentMesher<'a> {
    surface: ViewedSurface<'a>,
    reuse: TileReuse,
}

/// How many tiles of a mesh were reused from the mesh before, and how many were built and proved for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileReuse {
    /// Tiles reused.
    pub kept: u64,
    /// Tiles built and proved.
    pub made: u64,
}

enum ViewedSurface<'a> {
    Sheets(Box<ViewedSheets<'a>>),
    Triangles(&'a CageMesher<'a>),
}

struct ViewedSheets<'a> {
    sheets: Box<dyn PatchSurface<'a> + Send + 'a>,
    adjacency: PatchAdjacency,
    /// The tiles of the last mesh.
    tiles: Option<CertifiedTiles<'a>>,
}

impl ViewDependentMesher<'static> {
    /// Prepares patches, which are copied.
    ///
    /// # Errors
    /// [`Failure::Refused`] for reasons that lie in the patches: see [`patches_to_mesh`](super::patches_to_mesh()).
    pub fn from_patches(patches: &[Patch]) -> Result<Self, TessellationFailure> {
        Ok(Self::from_sheets(Box::new(checked_patches(patches)?)))
    }
}

impl<'a> ViewDependentMesher<'a> {
    /// Prepares the limit surface of a cage.
    #[must_use]
    pub fn from_cage(cage: &'a CageMesher<'a>) -> Self {
        if cage.scheme() == Scheme::Loop {
            return Self { surface: ViewedSurface::Triangles(cage), reuse: TileReuse::default() };
        }
        Self::from_sheets(Box::new(cage.quad_sheets()))
    }

    fn from_sheets(sheets: Box<dyn PatchSurface<'a> + Send + 'a>) -> Self {
        let adjacency = sheets.adjacency();
        let surface = ViewedSurface::Sheets(Box::new(ViewedSheets { sheets, adjacency, tiles: None }));
        Self { surface, reuse: TileReuse::default() }
    }

    /// The mesh within a budget. After an error no tiles are kept, so the next mesh is built like the first.
    ///
    /// # Errors
    /// [`Failure::Refused`]: as for [`patches_to_mesh`](super::patches_to_mesh()), and if the budget has a number of
    /// triangles or an angle ([`RefusalCode::Unsupported`]). [`Failure::Cancelled`].
    pub fn mesh(&mut self, budget: &Budget, job: &Job) -> Result<Bounded<Mesh>, TessellationFailure> {
        budget.check_for_surfaces().map_err(Failure::Refused)?;
        if budget.triangles.is_some() || budget.angle_deg.is_some() {
            let message = "tiles are kept for pixels and lengths, not for a number of triangles or an angle";
            return Err(Failure::refused(RefusalCode::Unsupported, message));
        }
        self.reuse = TileReuse::default();
        let surface = match &mut self.surface {
            ViewedSurface::Triangles(cage) => {
                let mesh = cage.mesh(budget, job)?;
                self.reuse.made = mesh.shape.faces().len() as u64;
                return Ok(mesh);
            }
            ViewedSurface::Sheets(surface) => &mut **surface,
        };
        let allowance = Allowance {
            length: budget.length.map(Tolerance::get),
            pixels: budget.pixels.map(|px| (px.pixels, px.view.lens())),
            normal_deviation: None,
            share: 1.0,
            outline: None,
        };
        let ViewedSheets { sheets, adjacency, tiles } = surface;
        // Taken out, so that none are left after an error.
        let before = tiles.take();
        let (mesh, built) =
            job.run(|| PatchMesher::new(&**sheets, adjacency, job).mesh_from(before, &allowance))?;
        let is_met = budget.is_met_by(&mesh.bound);
        let mesh = mesh.met_if(is_met)?;
        let kept = built.n_kept();
        self.reuse = TileReuse { kept, made: built.n_tiles() - kept };
        *tiles = Some(built);
        Ok(mesh)
    }

    /// How many tiles of the last mesh were kept.
    #[must_use]
    pub fn reuse(&self) -> TileReuse {
        self.reuse
    }
}
