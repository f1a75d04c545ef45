//! The page that is filled with the data of a run, as it was built in `web/`.

use std::borrow::Cow;
use std::io;

use crate::page;

/// Where the data belongs.
const DATA: &str = "<!--rtf-data-->";

/// The page before and after the data.
#[derive(Debug)]
pub struct Template {
    pub head: Cow<'static, str>,
    pub tail: Cow<'static, str>,
}

impl Template {
    /// The page of this build.
    ///
    /// # Errors
    /// This build has none.
    pub fn built() -> io::Result<Self> {
        let missing =
            "this build of rtf has no page: run `make web` in its sources, then build it again";
        let unusable = || io::Error::new(io::ErrorKind::Unsupported, missing);
        let page = page::report_template().ok_or_else(unusable)?;
        let page = String::from_utf8(page.into_owned()).map_err(|_| unusable())?;
        Self::split(&page).ok_or_else(unusable)
    }

    /// A page with one place for data.
    pub fn split(page: &str) -> Option<Self> {
        let (head, tail) = page.split_once(DATA).filter(|(_, tail)| !tail.contains(DATA))?;
        Some(Self { head: head.to_owned().into(), tail: tail.to_owned().into() })
    }
}
