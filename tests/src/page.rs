//! Reads the page of `sph report`.

use quick_xml::Reader;
use quick_xml::events::Event;

/// A page, as far as tests look at it.
#[derive(Debug, Default)]
pub struct Page {
    /// Texts of all `figcaption` elements.
    pub captions: Vec<String>,
    /// Number of pictures.
    pub pictures: usize,
    /// The `d` attributes of all curves.
    pub curves: Vec<String>,
    /// All text.
    pub text: String,
    /// Values of attributes that load something or lead somewhere.
    pub links: Vec<String>,
}

impl Page {
    /// Reads a page strictly: it must be well-formed.
    ///
    /// # Panics
    ///
    /// With the place of the first mistake.
    #[track_caller]
    pub fn read(html: &str) -> Self {
        let mut page = Self::default();
        let mut reader = Reader::from_str(html);
        let mut open: Vec<String> = Vec::new();
        loop {
            let place = reader.buffer_position();
            let event = reader.read_event().unwrap_or_else(|error| panic!("byte {place}: {error}"));
            match event {
                Event::Start(element) => {
                    page.element(&element);
                    open.push(String::from_utf8_lossy(element.name().as_ref()).into_owned());
                    if open.ends_with(&["figcaption".into()]) {
                        page.captions.push(String::new());
                    }
                }
                Event::Empty(element) => page.element(&element),
                Event::End(_) => {
                    open.pop();
                }
                Event::Text(text) => {
                    let text = text.unescape().unwrap_or_else(|e| panic!("byte {place}: {e}"));
                    if open.last().is_some_and(|name| name == "figcaption") {
                        page.captions.last_mut().expect("it was opened").push_str(&text);
                    }
                    if !open.iter().any(|name| name == "style") {
                        page.text.push_str(&text);
                        page.text.push(' ');
                    }
                }
                Event::Eof => break,
                _ => {}
            }
        }
        assert!(open.is_empty(), "not closed: {open:?}");
        page
    }

    fn element(&mut self, element: &quick_xml::events::BytesStart<'_>) {
        let name = String::from_utf8_lossy(element.name().as_ref()).into_owned();
        assert!(!["script", "link", "iframe", "object"].contains(&name.as_str()), "a {name}");
        let mut class = String::new();
        let mut curve = None;
        for attribute in element.attributes() {
            let attribute = attribute.unwrap_or_else(|error| panic!("<{name}>: {error}"));
            let value = attribute.unescape_value().expect("a text").into_owned();
            match attribute.key.as_ref() {
                b"class" => class = value,
                b"d" => curve = Some(value),
                b"src" | b"href" | b"xlink:href" => self.links.push(value),
                key => assert!(!key.starts_with(b"on"), "a script in <{name}>"),
            }
        }
        self.pictures += usize::from(name == "image");
        if class == "line" {
            self.curves.extend(curve);
        }
    }

    /// Asserts that the page loads nothing.
    ///
    /// # Panics
    ///
    /// With the link that would.
    #[track_caller]
    pub fn assert_self_contained(&self) {
        for link in &self.links {
            assert!(
                link.starts_with("data:image/png;base64,"),
                "loads {}",
                &link[..link.len().min(80)]
            );
        }
    }
}
