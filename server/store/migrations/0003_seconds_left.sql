-- What the worker expects, so that clients need not guess it from the fraction. A forecast, not a promise.
ALTER TABLE job ADD COLUMN seconds_left REAL CHECK(seconds_left >= 0); -- NULL: nothing to tell it by
