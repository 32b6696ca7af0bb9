//! Work on a frame, apart from the work on others.

use jrdb_types::contained;

/// The work on a frame; a panic of it fails this frame only.
pub(crate) fn guarded<T, E>(work: impl FnOnce() -> Result<T, E>) -> Result<T, E>
where
    E: From<jrdb_pipeline::Error>,
{
    let panicked = |panic| E::from(jrdb_pipeline::Error::Panicked(panic));
    contained("the work on the frame", work).map_err(panicked)?
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    #[test]
    fn a_panic_of_the_work_is_an_error_of_its_frame() {
        let number = "seven".parse::<u8>().ok();
        let failed = guarded(|| -> Result<u8, Error> { Ok(number.expect("a number")) });
        let text = failed.unwrap_err().to_string();
        assert!(text.starts_with("the work on the frame panicked: a number"), "{text}");
        assert_eq!(guarded(|| Ok::<_, Error>(7)).unwrap(), 7);
    }
}
