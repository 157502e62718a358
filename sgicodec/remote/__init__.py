"""Files behind URLs (`https://`, `s3://` …), fetched as far as they are read, or sent. The only user of fsspec."""
