//! `StudioPage`: the files that are served, all in memory, each under one fixed URL. Those that are built into the command stay
//! compressed, as browsers ask for them.
use crate::fault::{Fault, plainly};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};

mod built {
    //! The archive that `build.rs` found.
    include!(concat!(env!("OUT_DIR"), "/page.rs"));
}

/// The most bytes of one file. Chosen: twice the largest, which is the command as a module.
const MOST_BYTES: u64 = 32 << 20;
/// The most files of a folder that is served. Chosen: every exhibit has two pages, a script or two, and perhaps a module.
const MOST_FILES: usize = 512;

/// The size of the decompression buffer.
const BUFFER: usize = 1 << 16;

/// The page that files are opened with.
const WORKBENCH: &str = "/workbench.html";
/// The page that the studio opens with: the lesson. A folder without it opens with its index.
const LESSON: &str = "/lesson.html";

/// One file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageFile {
    /// The content, compressed by Brotli if `is_packed`.
    pub bytes: Cow<'static, [u8]>,
    /// Whether it is compressed.
    pub is_packed: bool,
    /// Its media type.
    pub kind: &'static str,
}

impl PageFile {
    fn plain(bytes: Vec<u8>, kind: &'static str) -> Self {
        Self { bytes: bytes.into(), is_packed: false, kind }
    }

    /// The content for a client that does not decompress; nothing if the file is damaged, or larger than a page's file may be.
    pub fn unpacked(&self) -> Option<Vec<u8>> {
        if !self.is_packed {
            return Some(self.bytes.to_vec());
        }
        let mut content = Vec::new();
        let stream = brotli_decompressor::Decompressor::new(self.bytes.as_ref(), BUFFER);
        // One byte more, so that a larger file is not sent as if its beginning were all of it.
        stream.take(MOST_BYTES + 1).read_to_end(&mut content).ok()?;
        (content.len() as u64 <= MOST_BYTES).then_some(content)
    }
}

/// The files by the path of their URL. Only listed paths exist: a request is never turned into a path of the
/// file system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudioPage {
    files: BTreeMap<String, PageFile>,
    /// The first URL of a browser.
    home: String,
}

impl StudioPage {
    /// The page in `dir`; else the one built into this command; else one beside the command.
    ///
    /// # Errors
    /// If there is none; the message says how to get it.
    pub fn find(dir: Option<&Path>) -> Result<Self, Fault> {
        if let Some(dir) = dir {
            return Self::read(dir);
        }
        if let Some(archive) = built::ARCHIVE {
            let damaged =
                || Fault::input("damaged-page", "the page that is built into this command is damaged");
            return listed(archive).map(Self::new).ok_or_else(damaged);
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

    /// The first URL of a browser: the lesson, or the workbench with the opened files.
    pub fn home(&self) -> &str {
        &self.home
    }

    /// Adds files for the workbench, which requests them by number: file names never become URL paths.
    ///
    /// # Errors
    /// If the page has no workbench.
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
            let file = PageFile::plain(bytes, "application/octet-stream");
            self.files.insert(format!("/opened/{number}"), file);
        }
        Ok(self)
    }

    fn new(files: BTreeMap<String, PageFile>) -> Self {
        let home = if files.contains_key(LESSON) { LESSON } else { "/" };
        Self { files, home: home.into() }
    }

    /// Reads the files of a folder and its `assets`, without links.
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
                // Of the entry and not of its target: a link is no file here, so that none leads out of
                // the folder.
                let data = entry.metadata().map_err(|error| fault(&path, &plainly(&error)))?;
                if !data.is_file() {
                    continue;
                }
                if data.len() > MOST_BYTES || files.len() == MOST_FILES {
                    return Err(fault(&path, "a page has at most 512 files of 32 MiB each"));
                }
                let bytes = fs::read(&path).map_err(|error| fault(&path, &plainly(&error)))?;
                files.insert(format!("{prefix}{name}"), PageFile::plain(bytes, kind));
            }
        }
        if files.contains_key("/index.html") {
            Ok(Self::new(files))
        } else {
            Err(fault(dir, "there is no index.html in it; 'make studio' writes the page to studio/dist/page"))
        }
    }
}

/// The files of an archive: a line of JSON with names and lengths, then the bytes of all files in order, each
/// compressed by Brotli.
fn listed(archive: &'static [u8]) -> Option<BTreeMap<String, PageFile>> {
    let end = archive.iter().position(|byte| *byte == b'\n')?;
    let list: Vec<(String, usize)> = serde_json::from_slice(&archive[..end]).ok()?;
    let (mut files, mut rest) = (BTreeMap::new(), &archive[end + 1..]);
    for (path, len) in list {
        // The lengths are those of the archive itself, which may be damaged.
        let (bytes, after) = rest.split_at_checked(len)?;
        rest = after;
        let name = path.rsplit('/').next().unwrap_or(&path);
        if let Some(kind) = kind(name) {
            files.insert(format!("/{path}"), PageFile { bytes: bytes.into(), is_packed: true, kind });
        }
    }
    Some(files)
}

/// The folder of a page that is not built in: beside the command, in the usual data folder, or in the
/// checkout that the command was built in.
fn page_folder() -> Option<PathBuf> {
    let command = std::env::current_exe().ok()?.canonicalize().ok()?;
    let folder = command.parent()?;
    let mut places = vec![folder.join("studio"), folder.join("../share/chordal/studio")];
    // The command is two or three folders below the checkout: target/release/,
    // target/wasm32-unknown-unknown/release/.
    places.extend(folder.ancestors().skip(1).take(3).map(|root| root.join("studio/dist/page")));
    places.into_iter().find(|place| place.join("index.html").is_file())
}

/// A name with percent-encoding.
fn percent_encoded(name: &str) -> String {
    let encode = |byte: u8| match byte {
        byte if byte.is_ascii_alphanumeric() || b"._-".contains(&byte) => char::from(byte).to_string(),
        byte => format!("%{byte:02X}"),
    };
    name.bytes().map(encode).collect()
}

/// The media type of a file extension; other files are not served.
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
        "bin" => Some("application/octet-stream"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Folder;

    /// A folder for a page, with an `assets` folder.
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
        assert_eq!((page.get("/").unwrap().bytes.as_ref(), page.home()), (&b"<p>"[..], "/"));
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
    fn opens_with_its_lesson() {
        let folder = studio_folder("lesson");
        for name in ["index.html", "lesson.html"] {
            fs::write(folder.path(name), "<p>").unwrap();
        }
        assert_eq!(StudioPage::find(Some(folder.as_ref())).unwrap().home(), LESSON);
    }

    #[test]
    fn files_of_an_archive_are_served() {
        // `<p>`, `1` and `no`, as Node compresses them.
        let archive = b"[[\"index.html\",7],[\"assets/a.js\",5],[\"a.pem\",6]]\n\
            \x0b\x01\x80<p>\x03\x0b\x00\x801\x03\x8b\x00\x80no\x03";
        let files = listed(archive).unwrap();
        let names: Vec<&str> = files.keys().map(String::as_str).collect();
        assert_eq!(names, ["/assets/a.js", "/index.html"]);
        assert_eq!(files["/index.html"].unpacked().unwrap(), b"<p>");
        assert_eq!(files["/assets/a.js"].unpacked().unwrap(), b"1");
        let cut = PageFile { bytes: archive[49..52].into(), ..files["/index.html"].clone() };
        assert_eq!(cut.unpacked(), None);
        assert_eq!(listed(&archive[..archive.len() / 2]), None);
        assert_eq!(listed(b""), None);
        if let Some(built) = built::ARCHIVE {
            let page = listed(built).unwrap();
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
