//! The XML of a scene as a list of elements: files that it includes in their places, parameters replaced by their values.
//!
//! Nothing is expanded but the five entities of XML itself and `$parameters`, both within bounds.

use crate::load::{
    Format, LoadError, Place,
    error::{quoted, short},
    source::{Folder, growth_limit},
};
use quick_xml::{
    Reader,
    events::{BytesStart, Event},
};
use std::collections::HashMap;

/// Elements within elements; scenes have less than ten.
const MAX_DEPTH: usize = 64;
/// Attributes of one element; Mitsuba's have at most five.
const MAX_ATTRIBUTES: usize = 64;
/// Files within files, as in Mitsuba.
const MAX_INCLUDES: usize = 15;
/// Folders in which files are looked for.
const MAX_FOLDERS: usize = 64;
/// Bytes of a value with its parameters replaced.
const MAX_VALUE: usize = 1 << 20;

/// Names and values.
type Attributes = Vec<(Box<str>, Box<str>)>;

/// One element.
pub(super) struct Element {
    pub(super) tag: Box<str>,
    attributes: Attributes,
    /// Positions of its children in the document.
    pub(super) children: Vec<u32>,
    pub(super) line: u64,
    /// The file it is in.
    file: u32,
}

impl Element {
    /// The value of an attribute.
    pub(super) fn get(&self, key: &str) -> Option<&str> {
        self.attributes.iter().find(|(name, _)| **name == *key).map(|(_, value)| &**value)
    }

    /// The attribute `type`, which names a plugin.
    pub(super) fn plugin(&self) -> &str {
        self.get("type").unwrap_or_default()
    }

    /// What the element is for, in snake case.
    pub(super) fn name(&self) -> &str {
        self.get("name").unwrap_or_default()
    }
}

/// A scene's elements.
pub(super) struct Document<'a> {
    pub(super) elements: Vec<Element>,
    /// The children of the outermost element.
    pub(super) top: Vec<u32>,
    ids: HashMap<Box<str>, u32>,
    aliases: HashMap<Box<str>, Box<str>>,
    parameters: HashMap<Box<str>, Box<str>>,
    /// Names of the files, the scene's own first.
    files: Vec<String>,
    /// Where files are looked for, below the scene's folder.
    folders: Vec<String>,
    folder: Folder<'a>,
    /// Bytes that included files and replaced parameters may still take.
    left: u64,
    /// Bytes of all files that were read.
    pub(super) input: u64,
}

impl<'a> Document<'a> {
    /// Reads a scene.
    pub(super) fn read(bytes: &[u8], folder: Folder<'a>) -> Result<Self, LoadError> {
        let mut document = Self {
            elements: Vec::new(),
            top: Vec::new(),
            ids: HashMap::new(),
            aliases: HashMap::new(),
            parameters: HashMap::new(),
            files: vec![String::new()],
            folders: vec![String::new()],
            folder,
            left: growth_limit(bytes.len() as u64),
            input: bytes.len() as u64,
        };
        document.top = document.file(bytes, 0)?;
        Ok(document)
    }

    /// The element of that position.
    pub(super) fn at(&self, element: u32) -> &Element {
        &self.elements[element as usize]
    }

    /// The children of an element.
    pub(super) fn children(&self, element: u32) -> impl Iterator<Item = (u32, &Element)> {
        self.at(element).children.iter().map(|&child| (child, self.at(child)))
    }

    /// The child that a property's name belongs to; the last one counts.
    pub(super) fn property(&self, element: u32, name: &str) -> Option<(u32, &Element)> {
        self.children(element).filter(|(_, child)| child.name() == name).last()
    }

    /// The element with that id.
    pub(super) fn with_id(&self, id: &str) -> Option<u32> {
        let mut id = id;
        for _ in 0..=MAX_INCLUDES {
            match self.aliases.get(id) {
                Some(next) => id = next,
                None => break,
            }
        }
        self.ids.get(id).copied()
    }

    /// What an element stands for: itself, or what it refers to.
    pub(super) fn resolve(&self, element: u32) -> Option<u32> {
        match self.at(element) {
            reference if &*reference.tag == "ref" => self.with_id(reference.get("id")?),
            _ => Some(element),
        }
    }

    /// The error that something at that element is wrong.
    pub(super) fn invalid(&self, element: &Element, what: impl Into<String>, fix: &'static str) -> LoadError {
        self.wrong(element.file, element.line, what.into(), fix)
    }

    fn wrong(&self, file: u32, line: u64, what: String, fix: &'static str) -> LoadError {
        let what = match file {
            0 => what,
            _ => format!("{}: {what}", quoted(self.files[file as usize].as_bytes())),
        };
        LoadError::Invalid { format: Format::Mitsuba, place: Place::Line(line), what, fix }
    }

    /// Where a file is, by the folders of the scene.
    pub(super) fn find(&self, name: &str) -> String {
        let places = self.folders.iter().map(|folder| join(folder, name));
        places.into_iter().find(|place| self.folder.has(place)).unwrap_or_else(|| name.to_owned())
    }

    /// Reads a file that an element names.
    pub(super) fn bytes(&self, name: &str) -> Result<Vec<u8>, String> {
        self.folder.read(&self.find(name))
    }

    /// Reads one file; the children of its outermost element.
    fn file(&mut self, bytes: &[u8], depth: usize) -> Result<Vec<u32>, LoadError> {
        let file = self.files.len() as u32 - 1;
        let text =
            std::str::from_utf8(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)).map_err(|error| {
                let line = 1 + bytes[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count();
                self.wrong(file, line as u64, "the text is not UTF-8".to_owned(), "save it as UTF-8")
            })?;
        let mut reader = Reader::from_str(text);
        // Positions of the elements that are open, and their children so far.
        let mut open: Vec<Option<u32>> = Vec::new();
        let (mut top, mut line, mut counted) = (Vec::new(), 1, 0);
        let mut has_root = false;
        loop {
            let event = reader.read_event();
            let at = (reader.buffer_position() as usize).min(text.len());
            let damaged = |document: &Self, what: &dyn std::fmt::Display, line| {
                document.wrong(file, line, short(what), "the file was cut off or is no XML")
            };
            let event = event.map_err(|error| damaged(self, &error, line))?;
            let began = line;
            line += text.as_bytes()[counted..at].iter().filter(|&&byte| byte == b'\n').count() as u64;
            counted = at;
            let (start, is_empty) = match &event {
                Event::Start(start) => (start, false),
                Event::Empty(start) => (start, true),
                Event::End(_) => {
                    open.pop();
                    continue;
                }
                Event::Eof if open.is_empty() && has_root => return Ok(top),
                Event::Eof => return Err(damaged(self, &"the file ends within an element", line)),
                _ => continue,
            };
            if open.len() >= MAX_DEPTH {
                let what = format!("elements are nested more than {MAX_DEPTH} deep");
                return Err(self.wrong(file, line, what, "the file is damaged or no scene"));
            }
            let attributes = self.attributes(start, file, began)?;
            let tag = start.name().into_inner().to_ascii_lowercase();
            if open.is_empty() {
                if has_root || (depth == 0 && tag != "scene") {
                    let what = format!("{} is not Mitsuba's element <scene>", quoted(tag.as_bytes()));
                    return Err(self.wrong(file, began, what, "give the file the extension of what it is"));
                }
                has_root = true;
                if tag == "scene" {
                    if !is_empty {
                        open.push(None);
                    }
                    continue;
                }
            }
            let element = Element { tag: tag.into(), attributes, children: Vec::new(), line: began, file };
            let added = self.element(element, depth)?;
            let siblings = match open.last().copied().flatten() {
                Some(parent) => &mut self.elements[parent as usize].children,
                None => &mut top,
            };
            siblings.extend(&added);
            if !is_empty {
                open.push(added.first().copied());
            }
        }
    }

    fn attributes(&mut self, start: &BytesStart<'_>, file: u32, line: u64) -> Result<Attributes, LoadError> {
        let is_default = start.name().into_inner() == "default";
        let mut attributes = Attributes::new();
        // The check for repeated attributes takes time that grows with their square.
        for attribute in start.attributes().with_checks(false) {
            let wrong = |error: &dyn std::fmt::Display| {
                self.wrong(file, line, short(error), "the file is damaged or no scene")
            };
            let attribute = attribute.map_err(|error| wrong(&error))?;
            if attributes.len() == MAX_ATTRIBUTES {
                return Err(wrong(&"an element has too many attributes"));
            }
            // Knows XML's own five entities and no others.
            let value = attribute
                .normalized_value(quick_xml::XmlVersion::Implicit1_0)
                .map_err(|error| wrong(&error))?;
            let key = attribute.key.into_inner();
            let value = self.replaced(&value)?;
            let value = if key == "name" && !is_default { snake_case(&value) } else { value };
            attributes.push((key.into(), value.into()));
        }
        Ok(attributes)
    }

    /// Keeps an element, or does what it says at once; the elements that stand for it.
    fn element(&mut self, element: Element, depth: usize) -> Result<Vec<u32>, LoadError> {
        let value = element.get("value").or_else(|| element.get("filename"));
        match (&*element.tag, element.get("name"), value) {
            ("default", Some(name), Some(value)) => {
                self.parameters.entry(name.into()).or_insert_with(|| value.into());
                return Ok(Vec::new());
            }
            ("path", _, Some(value)) => {
                self.look_in(value);
                return Ok(Vec::new());
            }
            ("alias", ..) => {
                if let (Some(id), Some(new)) = (element.get("id"), element.get("as")) {
                    self.aliases.insert(new.into(), id.into());
                }
                return Ok(Vec::new());
            }
            ("include", _, Some(name)) => return self.include(&element, name, depth),
            _ => {}
        }
        let position = self.elements.len() as u32;
        if let Some(id) = element.get("id").filter(|_| !matches!(&*element.tag, "ref")) {
            self.ids.entry(id.into()).or_insert(position);
        }
        self.elements.push(element);
        Ok(vec![position])
    }

    fn include(&mut self, element: &Element, name: &str, depth: usize) -> Result<Vec<u32>, LoadError> {
        if depth >= MAX_INCLUDES {
            let what = format!("files include one another more than {MAX_INCLUDES} deep");
            return Err(self.invalid(element, what, "a file must not include itself"));
        }
        let place = self.find(name);
        let bytes = self.folder.read(&place).map_err(|why| {
            let what = format!("the file {} cannot be included: {why}", quoted(name.as_bytes()));
            self.invalid(element, what, "put it beside the scene file")
        })?;
        self.input += bytes.len() as u64;
        // Each costs something, so that many empty ones end as well.
        self.spend(bytes.len() as u64 + 4096)?;
        if let Some((folder, _)) = place.rsplit_once('/') {
            self.look_in(folder);
        }
        self.files.push(place);
        self.file(&bytes, depth + 1)
    }

    fn look_in(&mut self, folder: &str) {
        if self.folders.len() < MAX_FOLDERS && !self.folders.iter().any(|known| known == folder) {
            self.folders.push(folder.to_owned());
        }
    }

    fn spend(&mut self, bytes: u64) -> Result<(), LoadError> {
        self.left = self.left.checked_sub(bytes).ok_or(LoadError::OutOfProportion {
            what: "the included files and replaced parameters",
            limit: growth_limit(self.input),
            input: self.input,
            fix: "write the scene as one file",
        })?;
        Ok(())
    }

    /// A value with its parameters replaced, the longest names first. Names without a value stay: much of a scene is not read.
    fn replaced(&mut self, value: &str) -> Result<String, LoadError> {
        let mut out = String::new();
        let mut rest = value;
        while let Some(at) = rest.find('$') {
            out.push_str(&rest[..at]);
            rest = &rest[at + 1..];
            let name = |c: char| c.is_alphanumeric() || c == '_' || c == '-' || c == '.';
            let mut end = rest.find(|c| !name(c)).unwrap_or(rest.len()).min(256);
            while !rest.is_char_boundary(end) {
                end -= 1;
            }
            let ends = (1..=end).rev().filter(|&end| rest.is_char_boundary(end));
            let known = ends.filter_map(|end| Some((end, self.parameters.get(&rest[..end])?))).next();
            match known {
                Some((end, value)) => {
                    out.push_str(value);
                    rest = &rest[end..];
                }
                None => out.push('$'),
            }
            if out.len() > MAX_VALUE {
                break;
            }
        }
        if !out.is_empty() {
            self.spend(out.len() as u64)?;
        }
        out.push_str(rest);
        Ok(out)
    }
}

fn join(folder: &str, name: &str) -> String {
    if folder.is_empty() {
        name.to_owned()
    } else {
        format!("{}/{name}", folder.trim_end_matches(['/', '\\']))
    }
}

/// `toWorld` as Mitsuba wrote names before version 2 is `to_world` now, and `intIOR` is `int_ior`.
fn snake_case(name: &str) -> String {
    let mut out = String::with_capacity(name.len());
    let mut was_lower = false;
    for c in name.chars() {
        if c.is_uppercase() && was_lower {
            out.push('_');
        }
        was_lower = c.is_lowercase();
        out.extend(c.to_lowercase());
    }
    out
}
