//! URIs: embedded data, and references to other files, which are never opened.

/// A decoded data URI.
pub(super) struct DataUri {
    /// The media type, in lower case.
    pub mime: String,
    pub bytes: Vec<u8>,
}

/// Decodes a data URI. `None` if the text is another URI, an error if it is an invalid data URI.
///
/// The text is already in memory, and the decoded bytes take less.
pub(super) fn data_uri(text: &str) -> Option<Result<DataUri, &'static str>> {
    let scheme = text.get(..5)?;
    if !scheme.eq_ignore_ascii_case("data:") {
        return None;
    }
    Some(parse(&text[5..]))
}

fn parse(text: &str) -> Result<DataUri, &'static str> {
    let (head, body) = text.split_once(',').ok_or("a data URI without a comma")?;
    let mut parameters = head.split(';');
    let mime = parameters.next().unwrap_or_default();
    if !mime.is_empty() && mime.split('/').count() != 2 {
        return Err("a data URI with an invalid media type");
    }
    let parameters: Vec<&str> = parameters.collect();
    let (last, others) = match parameters.split_last() {
        Some((last, others)) => (*last, others),
        None => ("", &[][..]),
    };
    let is_base64 = last == "base64";
    if others.iter().any(|p| !p.contains('=')) || !(last.is_empty() || is_base64 || last.contains('=')) {
        return Err("a data URI with an invalid parameter");
    }
    let bytes = percent_decoded(body)?;
    let bytes = if is_base64 { base64(&bytes)? } else { bytes };
    let mime = if mime.is_empty() { "text/plain".to_owned() } else { mime.to_ascii_lowercase() };
    Ok(DataUri { mime, bytes })
}

fn percent_decoded(text: &str) -> Result<Vec<u8>, &'static str> {
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        if bytes[at] != b'%' {
            out.push(bytes[at]);
            at += 1;
            continue;
        }
        let hex = |b: Option<&u8>| b.and_then(|b| char::from(*b).to_digit(16));
        match (hex(bytes.get(at + 1)), hex(bytes.get(at + 2))) {
            (Some(high), Some(low)) => out.push((16 * high + low) as u8),
            _ => return Err("a data URI with an invalid percent escape"),
        }
        at += 3;
    }
    Ok(out)
}

/// Decodes both alphabets. All padding may be omitted, but not a part of it.
fn base64(text: &[u8]) -> Result<Vec<u8>, &'static str> {
    let padding = text.iter().rev().take(2).take_while(|b| **b == b'=').count();
    let remainder = text.len() % 4;
    if remainder == 1 || (padding > 0 && remainder > 0) {
        return Err("base64 that ends inside a byte");
    }
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut n_bits) = (0_u32, 0);
    for byte in &text[..text.len() - padding] {
        let six = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return Err("base64 with a character that is none of its 64"),
        };
        bits = bits << 6 | u32::from(six);
        n_bits += 6;
        if n_bits >= 8 {
            n_bits -= 8;
            out.push((bits >> n_bits & 0xFF) as u8);
        }
    }
    Ok(out)
}

/// Whether the validator's parser rejects a text as a URI: it begins with the colon of an empty scheme, its
/// host is a broken IPv6 address, or its port is not a number.
pub(super) fn is_invalid(text: &str) -> bool {
    if text.starts_with(':') {
        return true;
    }
    let Some((_, rest)) = text.split_once("//") else { return false };
    let authority = rest.split(['/', '?', '#']).next().unwrap_or_default();
    let host_and_port = authority.rsplit('@').next().unwrap_or_default();
    if host_and_port.starts_with('[') && !host_and_port.contains(']') {
        return true;
    }
    let port = host_and_port.rsplit(']').next().unwrap_or_default().split_once(':').map(|(_, port)| port);
    port.is_some_and(|port| !port.bytes().all(|b| b.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decodes_base64_and_percent_escapes() {
        let bytes = |text| data_uri(text).expect("a data URI").map(|data| (data.mime, data.bytes));
        assert_eq!(bytes("data:A/b;base64,AAEC/w=="), Ok(("a/b".to_owned(), vec![0, 1, 2, 255])));
        assert_eq!(bytes("data:A/b;base64,AAE"), Ok(("a/b".to_owned(), vec![0, 1])));
        assert_eq!(bytes("data:,a%20b"), Ok(("text/plain".to_owned(), b"a b".to_vec())));
        assert_eq!(bytes("DATA:a/b;base64,-_-_").map(|b| b.1), Ok(vec![0xFB, 0xFF, 0xBF]));
        for broken in [
            "data:a/b;base64,AAEAA",
            "data:a/b;base64,AA=",
            "data:a/b;base64,A A=",
            "data:a/b;base64,A===",
            "data:a/b;base64,AA==AA==",
            "data:a/b;base64",
            "data:ab,",
            "data:a/b;x,",
            "data:,%f",
        ] {
            assert!(bytes(broken).is_err(), "{broken}");
        }
        assert!(data_uri("dat").is_none());
        assert!(data_uri("€€€€").is_none());
    }
}
