// Why nobody answers: the run is over, or another one is behind the same door, with a token of its own.

export async function isLockedOut() {
  try {
    return (await fetch("/", { cache: "no-store" })).status === 403;
  } catch {
    return false;
  }
}

export const LOCKED_OUT = "another run is at this address now: open the one that it printed";
