//! `StudioPage`: the files that are served, all of them in memory, each under the one name that it is asked
//! for by.
use crate::fault::{Fault, plainly};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};

mod built {
    //! What `build.rs` found.
    include!(concat!(env!("OUT_DIR"), "/page.rs"));
}

/// The most bytes of one file: twice the command as a module, the largest.
const MOST_BYTES: u64 = 32 << 20;
/// The most files of a folder that is served: every exhibit has two pages and a script or two.
const MOST_FILES: usize = 256;

/// Bytes that are decompressed at once.
const BUFFER: usize = 1 << 16;

/// The page that files are opened with.
const WORKBENCH: &str = "/workbench.html";

/// One file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageFile {
    /// What it holds.
    pub bytes: Cow<'static, [u8]>,
    /// Its media type.
    pub kind: &'static str,
}

/// The files by the path of their URL. What is not listed here does not exist: no request ever becomes a path
/// of the file system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudioPage {
    files: BTreeMap<String, PageFile>,
    /// Where a browser begins.
    home: String,
}

impl StudioPage {
    /// The page in `dir`; else the one built into this command; else one that lies beside it.
    ///
    /// # Errors
    /// When there is none, with the sentence how to get it.
    pub fn find(dir: Option<&Path>) -> Result<Self, Fault> {
        if let Some(dir) = dir {
            return Self::read(dir);
        }
        if let Some(archive) = built::ARCHIVE {
            let damaged =
                || Fault::input("damaged-page", "the page that is built into this command is damaged");
            return unpacked(archive).map(Self::new).ok_or_else(damaged);
        }
        match page_folder() {
            Some(dir) => Self::read(&dir),
            None => Err(Fault::input(
                "no-page",
                "this chordal was built without the studio's page: run 'make studio' in its source, or name the page's folder with --dir",
            )),
        }
    }

    /// The file for the path of a URL.
    pub fn get(&self, path: &str) -> Option<&PageFile> {
        self.files.get(if path == "/" { "/index.html" } else { path })
    }

    /// Where a browser begins: the first page, or the workbench with what was opened.
    pub fn home(&self) -> &str {
        &self.home
    }

    /// Puts files on the workbench, which asks for them by number: their names never become paths of a URL.
    ///
    /// # Errors
    /// When the page has no workbench.
    pub fn opened(mut self, files: Vec<(String, Vec<u8>)>) -> Result<Self, Fault> {
        if files.is_empty() {
            return Ok(self);
        }
        if !self.files.contains_key(WORKBENCH) {
            return Err(Fault::input("no-workbench", "this studio has no workbench to open files with"));
        }
        let names: Vec<String> =
            files.iter().map(|(name, _)| format!("open={}", percent_encoded(name))).collect();
        self.home = format!("{WORKBENCH}?{}", names.join("&"));
        for (number, (_, bytes)) in files.into_iter().enumerate() {
            let file = PageFile { bytes: bytes.into(), kind: "application/octet-stream" };
            self.files.insert(format!("/opened/{number}"), file);
        }
        Ok(self)
    }

    fn new(files: BTreeMap<String, PageFile>) -> Self {
        Self { files, home: "/".into() }
    }

    /// Lists and reads a folder and its `assets`, links left out.
    fn read(dir: &Path) -> Result<Self, Fault> {
        let fault = |path: &Path, why: &str| Fault::input("unreadable", format!("{}: {why}", path.display()));
        let mut files = BTreeMap::new();
        for (prefix, folder) in [("/", dir.to_path_buf()), ("/assets/", dir.join("assets"))] {
            let entries = match fs::read_dir(&folder) {
                Ok(entries) => entries,
                Err(_) if prefix != "/" => continue,
                Err(error) => return Err(fault(&folder, &plainly(&error))),
            };
            for entry in entries {
                let entry = entry.map_err(|error| fault(&folder, &plainly(&error)))?;
                let (path, name) = (entry.path(), entry.file_name());
                let Some((name, kind)) = name.to_str().and_then(|name| Some((name, kind(name)?))) else {
                    continue;
                };
                let data = entry.metadata().map_err(|error| fault(&path, &plainly(&error)))?;
                if !data.is_file() {
                    continue;
                }
                if data.len() > MOST_BYTES || files.len() == MOST_FILES {
                    return Err(fault(&path, "a page has at most 256 files of 32 MiB each"));
                }
                let bytes = fs::read(&path).map_err(|error| fault(&path, &plainly(&error)))?;
                files.insert(format!("{prefix}{name}"), PageFile { bytes: bytes.into(), kind });
            }
        }
        if files.contains_key("/index.html") {
            Ok(Self::new(files))
        } else {
            Err(fault(dir, "there is no index.html in it; 'make studio' writes the page to studio/dist/page"))
        }
    }
}

/// The files of an archive: a line of JSON with names and lengths, then the bytes of one after the other, all compressed
/// together by Brotli.
fn unpacked(archive: &[u8]) -> Option<BTreeMap<String, PageFile>> {
    let mut whole = Vec::new();
    brotli_decompressor::Decompressor::new(archive, BUFFER).read_to_end(&mut whole).ok()?;
    let end = whole.iter().position(|byte| *byte == b'\n')?;
    let list: Vec<(String, usize)> = serde_json::from_slice(&whole[..end]).ok()?;
    let (mut files, mut rest) = (BTreeMap::new(), &whole[end + 1..]);
    for (path, len) in list {
        let (bytes, after) = rest.split_at_checked(len)?;
        rest = after;
        let name = path.rsplit('/').next().unwrap_or(&path);
        if let Some(kind) = kind(name) {
            files.insert(format!("/{path}"), PageFile { bytes: bytes.to_vec().into(), kind });
        }
    }
    Some(files)
}

/// Where a page lies that was not built in: beside the command, where programs keep their data, or in the
/// checkout that the command was built in.
fn page_folder() -> Option<PathBuf> {
    let command = std::env::current_exe().ok()?.canonicalize().ok()?;
    let folder = command.parent()?;
    let mut places = vec![folder.join("studio"), folder.join("../share/chordal/studio")];
    // target/release/chordal and target/wasm32-unknown-unknown/release/… lie two or three folders down.
    places.extend(folder.ancestors().skip(1).take(3).map(|root| root.join("studio/dist/page")));
    places.into_iter().find(|place| place.join("index.html").is_file())
}

/// All but letters and digits as their bytes.
fn percent_encoded(name: &str) -> String {
    let encode = |byte: u8| match byte {
        byte if byte.is_ascii_alphanumeric() || b"._-".contains(&byte) => char::from(byte).to_string(),
        byte => format!("%{byte:02X}"),
    };
    name.bytes().map(encode).collect()
}

/// The media type by the end of a name; a file of another kind is not served.
fn kind(name: &str) -> Option<&'static str> {
    let plain = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"._-".contains(&byte));
    let (stem, end) = name.rsplit_once('.')?;
    if !plain || stem.is_empty() || name.starts_with('.') {
        return None;
    }
    match end {
        "html" => Some("text/html; charset=utf-8"),
        "js" => Some("text/javascript; charset=utf-8"),
        "css" => Some("text/css; charset=utf-8"),
        "svg" => Some("image/svg+xml"),
        "png" => Some("image/png"),
        "wasm" => Some("application/wasm"),
        "json" => Some("application/json"),
        "txt" => Some("text/plain; charset=utf-8"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Folder;

    /// A folder as a page's, with one for its assets.
    fn studio_folder(name: &str) -> Folder {
        let folder = Folder::new(&format!("page-{name}"));
        fs::create_dir_all(folder.path("assets")).unwrap();
        folder
    }

    #[test]
    fn lists_its_files_and_knows_no_path() {
        let folder = studio_folder("list");
        fs::write(folder.path("index.html"), "<p>").unwrap();
        fs::write(folder.path("assets/a-1.js"), "1").unwrap();
        fs::write(folder.path(".secret.txt"), "no").unwrap();
        fs::write(folder.path("key.pem"), "no").unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink("/etc/hostname", folder.path("link.txt")).unwrap();
        let page = StudioPage::find(Some(folder.as_ref())).unwrap();
        let names: Vec<&str> = page.files.keys().map(String::as_str).collect();
        assert_eq!(names, ["/assets/a-1.js", "/index.html"]);
        assert_eq!(page.get("/").unwrap().bytes.as_ref(), b"<p>");
        assert_eq!(page.get("/assets/a-1.js").unwrap().kind, "text/javascript; charset=utf-8");
        for path in [
            "/assets/../index.html",
            "/assets",
            "//index.html",
            "/%69ndex.html",
            "/../index.html",
            "index.html",
            "",
        ] {
            assert_eq!(page.get(path), None, "{path}");
        }
    }

    #[test]
    fn files_of_an_archive_are_served() {
        // `[["index.html",3],["assets/a.js",1],["a.pem",2]]`, then `<p>1no`, as Node compresses it.
        let archive = b"\x0b\x1b\x80[[\"index.html\",3],[\"assets/a.js\",1],[\"a.pem\",2]]\n<p>1no\x03";
        let files = unpacked(archive).unwrap();
        let names: Vec<&str> = files.keys().map(String::as_str).collect();
        assert_eq!(names, ["/assets/a.js", "/index.html"]);
        assert_eq!(
            (files["/index.html"].bytes.as_ref(), files["/assets/a.js"].bytes.as_ref()),
            (&b"<p>"[..], &b"1"[..])
        );
        assert_eq!(unpacked(&archive[..archive.len() / 2]), None);
        assert_eq!(unpacked(b""), None);
        if let Some(built) = built::ARCHIVE {
            let page = unpacked(built).unwrap();
            assert!(page.contains_key("/index.html") && page.contains_key(WORKBENCH), "{:?}", page.keys());
        }
    }

    #[test]
    fn a_folder_without_a_page_is_refused() {
        let folder = studio_folder("empty");
        let fault = StudioPage::find(Some(folder.as_ref())).unwrap_err();
        assert!(fault.to_string().contains("index.html"), "{fault}");
        let fault = StudioPage::find(Some(&folder.path("nowhere"))).unwrap_err();
        assert!(fault.to_string().contains("no such file"), "{fault}");
    }
}
