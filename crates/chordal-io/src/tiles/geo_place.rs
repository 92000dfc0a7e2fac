//! `GeoPlace`: a place on the Earth for a tileset.
use std::str::FromStr;

/// The equatorial radius of the WGS 84 ellipsoid, in metres: defined.
const EQUATORIAL_RADIUS: f64 = 6_378_137.0;

/// The flattening of the WGS 84 ellipsoid: defined.
const FLATTENING: f64 = 1.0 / 298.257_223_563;

/// A place on the Earth by its geodetic coordinates (WGS 84).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeoPlace {
    latitude: f64,
    longitude: f64,
    height: f64,
}

impl GeoPlace {
    /// A place at a latitude north and a longitude east, in degrees, and at a height above the ellipsoid, in
    /// metres. `None` beyond 90 degrees of latitude or 360 of longitude, and for values that are not finite.
    ///
    /// ```
    /// use chordal_io::tiles::GeoPlace;
    /// assert!(GeoPlace::new(52.52, 13.405, 34.0).is_some());
    /// assert!(GeoPlace::new(91.0, 0.0, 0.0).is_none());
    /// ```
    #[must_use]
    pub fn new(latitude: f64, longitude: f64, height: f64) -> Option<Self> {
        let is_place = latitude.abs() <= 90.0 && longitude.abs() <= 360.0 && height.is_finite();
        is_place.then_some(Self { latitude, longitude, height })
    }

    /// The column-major matrix from metres east, north and up of the place to metres from the centre of the
    /// Earth, x through longitude 0 on the equator, z through the North Pole (EPSG:4978): the transform of a
    /// tileset's root. Its rounding is below 10⁻⁸ m.
    ///
    /// Source: National Imagery and Mapping Agency, *World Geodetic System 1984*, TR8350.2, 3rd ed., 2000.
    ///
    /// ```
    /// use chordal_io::tiles::GeoPlace;
    /// let matrix = GeoPlace::new(0.0, 0.0, 100.0).expect("a place").matrix();
    /// // East is y, north is z, and up is x.
    /// assert_eq!(matrix[12..15], [6_378_237.0, 0.0, 0.0]);
    /// assert_eq!(matrix[8..11], [1.0, 0.0, 0.0]);
    /// ```
    #[must_use]
    pub fn matrix(&self) -> [f64; 16] {
        let (sin_lat, cos_lat) = sin_cos(self.latitude);
        let (sin_lon, cos_lon) = sin_cos(self.longitude);
        let squared_eccentricity = FLATTENING * (2.0 - FLATTENING);
        let normal = EQUATORIAL_RADIUS / (1.0 - squared_eccentricity * sin_lat * sin_lat).sqrt();
        let from_axis = (normal + self.height) * cos_lat;
        let [x, y] = [from_axis * cos_lon, from_axis * sin_lon];
        let z = (normal * (1.0 - squared_eccentricity) + self.height) * sin_lat;
        let east = [-sin_lon, cos_lon, 0.0];
        let north = [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat];
        let up = [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat];
        let mut matrix = [0.0; 16];
        for (column, axis) in matrix.chunks_exact_mut(4).zip([east, north, up, [x, y, z]]) {
            // Adding zero removes the sign of −0.
            column[..3].iter_mut().zip(axis).for_each(|(out, x)| *out = x + 0.0);
        }
        matrix[15] = 1.0;
        matrix
    }
}

/// The sine and cosine of degrees: exact at quarters of a turn, and the same on every machine.
fn sin_cos(degrees: f64) -> (f64, f64) {
    let quarters = (degrees / 90.0).round();
    let (sin, cos) = libm::sincos((degrees - 90.0 * quarters).to_radians());
    match quarters.rem_euclid(4.0) as u8 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

impl FromStr for GeoPlace {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || {
            "a place is LATITUDE,LONGITUDE or LATITUDE,LONGITUDE,HEIGHT: degrees north and east, metres above the ellipsoid".to_owned()
        };
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
        let place = match *numbers.map_err(|_| expected())? {
            [latitude, longitude] => Self::new(latitude, longitude, 0.0),
            [latitude, longitude, height] => Self::new(latitude, longitude, height),
            _ => return Err(expected()),
        };
        place.ok_or_else(|| "latitudes are from -90 to 90 degrees, longitudes from -360 to 360".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_where_others_say_they_are() {
        // Expected values: PROJ 9, EPSG:4979 to EPSG:4978.
        for (place, expected) in PROJ {
            let matrix = place.parse::<GeoPlace>().expect("a place").matrix();
            let off = (0..3).map(|k| (matrix[12 + k] - expected[k]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-7, "{place}: {off} m off");
            // The axes form a rotation.
            for (i, j) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
                let dot: f64 = (0..3).map(|k| matrix[4 * i + k] * matrix[4 * j + k]).sum();
                assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-15, "{place}");
            }
            let cross = matrix[0] * (matrix[5] * matrix[10] - matrix[6] * matrix[9])
                - matrix[1] * (matrix[4] * matrix[10] - matrix[6] * matrix[8])
                + matrix[2] * (matrix[4] * matrix[9] - matrix[5] * matrix[8]);
            assert!((cross - 1.0).abs() < 1e-15, "{place} is mirrored");
        }
    }

    #[test]
    fn what_is_no_place_is_refused() {
        for text in ["", "1", "1,2,3,4", "a,b", "91,0", "0,361", "0,0,inf", "nan,0"] {
            assert!(text.parse::<GeoPlace>().is_err(), "{text}");
        }
    }

    /// Places, and their coordinates by PROJ.
    const PROJ: [(&str, [f64; 3]); 4] = [
        ("52.52,13.405,34", [3_783_265.180_121_165, 901_649.796_600_969_3, 5_038_246.081_059_04]),
        ("-33.8568, 151.2153, 5", [-4_646_972.276_464_276, 2_553_078.919_527_07, -3_533_269.913_085_934]),
        ("90,0", [0.0, 0.0, 6_356_752.314_245_179]),
        ("40.6892,-74.0445,93", [1_331_360.037_900_869, -4_656_651.149_354_034, 4_136_374.030_496_642]),
    ];
}
