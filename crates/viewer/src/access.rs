//! Who may see and steer.

use axum::http::{HeaderMap, header};
use std::io;
use std::net::IpAddr;

/// Who may connect: programs and browsers of this machine, or whoever knows a token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Access {
    token: Option<String>,
}

impl Access {
    /// What an address to listen at asks for: none where only this machine can reach it, a random token of
    /// 128 bits elsewhere.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub fn for_address(address: IpAddr) -> io::Result<Self> {
        if address.is_loopback() {
            return Ok(Self { token: None });
        }
        let mut bits = [0; 16];
        getrandom::fill(&mut bits)?;
        let token = format!("{:032x}", u128::from_le_bytes(bits));
        Ok(Self { token: Some(token) })
    }
    /// Whoever knows this token.
    pub fn with_token(token: impl Into<String>) -> Self {
        Self {
            token: Some(token.into()),
        }
    }
    /// The token, if one is needed.
    pub fn token(&self) -> Option<&str> {
        self.token.as_deref()
    }

    /// Whether a request may pass; else why not, and what to do.
    ///
    /// Without a token the request must name this machine, and come from a page of this server: other pages in
    /// the same browser can send requests here too, under a name of their own that they let point here.
    pub(crate) fn check(
        &self,
        headers: &HeaderMap,
        given: Option<&str>,
    ) -> Result<(), &'static str> {
        let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
        let host = text(header::HOST).unwrap_or_default();
        if headers.contains_key(header::ORIGIN) {
            let origin = text(header::ORIGIN).unwrap_or_default();
            let from = origin.split_once("://").map(|(_, host)| host);
            if from != Some(host) {
                return Err("this page is not of this server: open the address that it printed");
            }
        }
        match &self.token {
            Some(token) if !same(token, given.unwrap_or_default()) => Err(
                "a token is needed: open the whole address that the server printed, with `?token=`",
            ),
            None if !is_this_machine(host) => {
                Err("this server answers to localhost only: open the address that it printed")
            }
            _ => Ok(()),
        }
    }
}

/// Whether a `Host` header names this machine.
fn is_this_machine(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|b| b.is_ascii_digit()) => name,
        _ => host,
    };
    let bare = name.trim_start_matches('[').trim_end_matches(']');
    name == "localhost" || bare.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback())
}

/// Compares in a time that does not tell how much of the guess was right.
fn same(token: &str, guess: &str) -> bool {
    let pairs = token.bytes().zip(guess.bytes());
    token.len() == guess.len() && pairs.fold(0, |differs, (a, b)| differs | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    fn passes(
        access: &Access,
        host: &'static str,
        origin: Option<&'static str>,
        token: &str,
    ) -> bool {
        let mut headers = HeaderMap::new();
        headers.insert(header::HOST, HeaderValue::from_static(host));
        if let Some(origin) = origin {
            headers.insert(header::ORIGIN, HeaderValue::from_static(origin));
        }
        access.check(&headers, Some(token)).is_ok()
    }

    #[test]
    fn without_a_token_only_pages_of_this_server_pass() {
        let access = Access::for_address(IpAddr::from([127, 0, 0, 1])).unwrap();
        assert_eq!(access.token(), None);
        assert!(passes(&access, "localhost:8080", None, ""));
        assert!(passes(
            &access,
            "127.0.0.1:8080",
            Some("http://127.0.0.1:8080"),
            ""
        ));
        assert!(passes(&access, "[::1]:8080", Some("http://[::1]:8080"), ""));
        assert!(!passes(
            &access,
            "127.0.0.1:8080",
            Some("http://evil.example"),
            ""
        ));
        assert!(!passes(&access, "127.0.0.1:8080", Some("null"), ""));
        assert!(!passes(
            &access,
            "evil.example:8080",
            Some("http://evil.example:8080"),
            ""
        ));
    }

    #[test]
    fn elsewhere_a_token_is_needed_and_each_server_has_its_own() {
        let access = Access::for_address(IpAddr::from([0, 0, 0, 0])).unwrap();
        let token = access.token().unwrap().to_owned();
        assert_eq!(token.len(), 32);
        assert!(passes(
            &access,
            "robot.lab:8080",
            Some("http://robot.lab:8080"),
            &token
        ));
        assert!(!passes(&access, "robot.lab:8080", None, ""));
        assert!(!passes(&access, "robot.lab:8080", None, &token[1..]));
        assert!(!passes(&access, "localhost:8080", None, "wrong"));
        assert_ne!(
            Access::for_address(IpAddr::from([0, 0, 0, 0])).unwrap(),
            access
        );
    }
}
