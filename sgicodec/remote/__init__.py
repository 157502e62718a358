"""Files behind URLs (`https://`, `s3://` …), of which only what is read is fetched. The only user of fsspec."""
