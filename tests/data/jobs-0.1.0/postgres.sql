-- What a tetstreamd with the tables of 0.1.0 left in PostgreSQL (pg_dump --inserts): one job done, one queued, one cancelled.
CREATE TABLE counters (
    name text NOT NULL COLLATE pg_catalog."C",
    value bigint NOT NULL
);
CREATE SEQUENCE event_ids
    START WITH 1
    INCREMENT BY 1
    NO MINVALUE
    NO MAXVALUE
    CACHE 1;
CREATE TABLE events (
    id bigint DEFAULT nextval('event_ids'::regclass) NOT NULL,
    revision bigint NOT NULL,
    job_id text NOT NULL COLLATE pg_catalog."C",
    space text NOT NULL COLLATE pg_catalog."C",
    version bigint NOT NULL,
    change bigint NOT NULL,
    state bigint NOT NULL,
    chunk_count bigint NOT NULL,
    done_chunks bigint NOT NULL,
    shard_count bigint NOT NULL,
    done_shards bigint NOT NULL,
    dead_shards bigint NOT NULL,
    time_us bigint NOT NULL
)
PARTITION BY RANGE (job_id);
CREATE TABLE events_06610e82134000_0661229feaa000 (
    id bigint DEFAULT nextval('event_ids'::regclass) NOT NULL,
    revision bigint NOT NULL,
    job_id text NOT NULL COLLATE pg_catalog."C",
    space text NOT NULL COLLATE pg_catalog."C",
    version bigint NOT NULL,
    change bigint NOT NULL,
    state bigint NOT NULL,
    chunk_count bigint NOT NULL,
    done_chunks bigint NOT NULL,
    shard_count bigint NOT NULL,
    done_shards bigint NOT NULL,
    dead_shards bigint NOT NULL,
    time_us bigint NOT NULL
);
CREATE TABLE events_0661229feaa000_066136bdc20000 (
    id bigint DEFAULT nextval('event_ids'::regclass) NOT NULL,
    revision bigint NOT NULL,
    job_id text NOT NULL COLLATE pg_catalog."C",
    space text NOT NULL COLLATE pg_catalog."C",
    version bigint NOT NULL,
    change bigint NOT NULL,
    state bigint NOT NULL,
    chunk_count bigint NOT NULL,
    done_chunks bigint NOT NULL,
    shard_count bigint NOT NULL,
    done_shards bigint NOT NULL,
    dead_shards bigint NOT NULL,
    time_us bigint NOT NULL
);
CREATE TABLE events_066136bdc20000_06614adb996000 (
    id bigint DEFAULT nextval('event_ids'::regclass) NOT NULL,
    revision bigint NOT NULL,
    job_id text NOT NULL COLLATE pg_catalog."C",
    space text NOT NULL COLLATE pg_catalog."C",
    version bigint NOT NULL,
    change bigint NOT NULL,
    state bigint NOT NULL,
    chunk_count bigint NOT NULL,
    done_chunks bigint NOT NULL,
    shard_count bigint NOT NULL,
    done_shards bigint NOT NULL,
    dead_shards bigint NOT NULL,
    time_us bigint NOT NULL
);
CREATE TABLE events_default (
    id bigint DEFAULT nextval('event_ids'::regclass) NOT NULL,
    revision bigint NOT NULL,
    job_id text NOT NULL COLLATE pg_catalog."C",
    space text NOT NULL COLLATE pg_catalog."C",
    version bigint NOT NULL,
    change bigint NOT NULL,
    state bigint NOT NULL,
    chunk_count bigint NOT NULL,
    done_chunks bigint NOT NULL,
    shard_count bigint NOT NULL,
    done_shards bigint NOT NULL,
    dead_shards bigint NOT NULL,
    time_us bigint NOT NULL
);
CREATE TABLE jobs (
    id text NOT NULL COLLATE pg_catalog."C",
    space text NOT NULL COLLATE pg_catalog."C",
    display_name bytea NOT NULL,
    spec bytea NOT NULL,
    header bytea NOT NULL,
    labels text NOT NULL,
    rank bigint NOT NULL,
    max_attempts bigint NOT NULL,
    state bigint NOT NULL,
    phase bigint NOT NULL,
    version bigint NOT NULL,
    error bytea NOT NULL,
    ttl_us bigint NOT NULL,
    timeout_us bigint NOT NULL,
    create_us bigint NOT NULL,
    start_us bigint NOT NULL,
    plan_us bigint NOT NULL,
    finish_us bigint NOT NULL,
    expire_us bigint NOT NULL,
    stop_us bigint NOT NULL,
    chunk_count bigint NOT NULL,
    done_chunks bigint NOT NULL,
    shard_count bigint NOT NULL,
    done_shards bigint NOT NULL,
    dead_shards bigint NOT NULL,
    alarms bigint NOT NULL,
    input text DEFAULT ''::text NOT NULL COLLATE pg_catalog."C"
)
PARTITION BY RANGE (id);
CREATE TABLE jobs_06610e82134000_0661229feaa000 (
    id text NOT NULL COLLATE pg_catalog."C",
    space text NOT NULL COLLATE pg_catalog."C",
    display_name bytea NOT NULL,
    spec bytea NOT NULL,
    header bytea NOT NULL,
    labels text NOT NULL,
    rank bigint NOT NULL,
    max_attempts bigint NOT NULL,
    state bigint NOT NULL,
    phase bigint NOT NULL,
    version bigint NOT NULL,
    error bytea NOT NULL,
    ttl_us bigint NOT NULL,
    timeout_us bigint NOT NULL,
    create_us bigint NOT NULL,
    start_us bigint NOT NULL,
    plan_us bigint NOT NULL,
    finish_us bigint NOT NULL,
    expire_us bigint NOT NULL,
    stop_us bigint NOT NULL,
    chunk_count bigint NOT NULL,
    done_chunks bigint NOT NULL,
    shard_count bigint NOT NULL,
    done_shards bigint NOT NULL,
    dead_shards bigint NOT NULL,
    alarms bigint NOT NULL,
    input text DEFAULT ''::text NOT NULL COLLATE pg_catalog."C"
);
CREATE TABLE jobs_0661229feaa000_066136bdc20000 (
    id text NOT NULL COLLATE pg_catalog."C",
    space text NOT NULL COLLATE pg_catalog."C",
    display_name bytea NOT NULL,
    spec bytea NOT NULL,
    header bytea NOT NULL,
    labels text NOT NULL,
    rank bigint NOT NULL,
    max_attempts bigint NOT NULL,
    state bigint NOT NULL,
    phase bigint NOT NULL,
    version bigint NOT NULL,
    error bytea NOT NULL,
    ttl_us bigint NOT NULL,
    timeout_us bigint NOT NULL,
    create_us bigint NOT NULL,
    start_us bigint NOT NULL,
    plan_us bigint NOT NULL,
    finish_us bigint NOT NULL,
    expire_us bigint NOT NULL,
    stop_us bigint NOT NULL,
    chunk_count bigint NOT NULL,
    done_chunks bigint NOT NULL,
    shard_count bigint NOT NULL,
    done_shards bigint NOT NULL,
    dead_shards bigint NOT NULL,
    alarms bigint NOT NULL,
    input text DEFAULT ''::text NOT NULL COLLATE pg_catalog."C"
);
CREATE TABLE jobs_066136bdc20000_06614adb996000 (
    id text NOT NULL COLLATE pg_catalog."C",
    space text NOT NULL COLLATE pg_catalog."C",
    display_name bytea NOT NULL,
    spec bytea NOT NULL,
    header bytea NOT NULL,
    labels text NOT NULL,
    rank bigint NOT NULL,
    max_attempts bigint NOT NULL,
    state bigint NOT NULL,
    phase bigint NOT NULL,
    version bigint NOT NULL,
    error bytea NOT NULL,
    ttl_us bigint NOT NULL,
    timeout_us bigint NOT NULL,
    create_us bigint NOT NULL,
    start_us bigint NOT NULL,
    plan_us bigint NOT NULL,
    finish_us bigint NOT NULL,
    expire_us bigint NOT NULL,
    stop_us bigint NOT NULL,
    chunk_count bigint NOT NULL,
    done_chunks bigint NOT NULL,
    shard_count bigint NOT NULL,
    done_shards bigint NOT NULL,
    dead_shards bigint NOT NULL,
    alarms bigint NOT NULL,
    input text DEFAULT ''::text NOT NULL COLLATE pg_catalog."C"
);
CREATE TABLE jobs_default (
    id text NOT NULL COLLATE pg_catalog."C",
    space text NOT NULL COLLATE pg_catalog."C",
    display_name bytea NOT NULL,
    spec bytea NOT NULL,
    header bytea NOT NULL,
    labels text NOT NULL,
    rank bigint NOT NULL,
    max_attempts bigint NOT NULL,
    state bigint NOT NULL,
    phase bigint NOT NULL,
    version bigint NOT NULL,
    error bytea NOT NULL,
    ttl_us bigint NOT NULL,
    timeout_us bigint NOT NULL,
    create_us bigint NOT NULL,
    start_us bigint NOT NULL,
    plan_us bigint NOT NULL,
    finish_us bigint NOT NULL,
    expire_us bigint NOT NULL,
    stop_us bigint NOT NULL,
    chunk_count bigint NOT NULL,
    done_chunks bigint NOT NULL,
    shard_count bigint NOT NULL,
    done_shards bigint NOT NULL,
    dead_shards bigint NOT NULL,
    alarms bigint NOT NULL,
    input text DEFAULT ''::text NOT NULL COLLATE pg_catalog."C"
);
CREATE TABLE queue (
    job_id text NOT NULL COLLATE pg_catalog."C",
    phase bigint NOT NULL,
    number bigint NOT NULL,
    first_chunk bigint NOT NULL,
    end_chunk bigint NOT NULL,
    rank bigint NOT NULL,
    space text NOT NULL COLLATE pg_catalog."C",
    state bigint NOT NULL,
    token bigint NOT NULL,
    worker text NOT NULL,
    attempt bigint NOT NULL,
    lease_us bigint NOT NULL,
    due_us bigint NOT NULL
)
WITH (autovacuum_vacuum_scale_factor='0.02', autovacuum_analyze_scale_factor='0.05');
CREATE TABLE requests (
    space text NOT NULL COLLATE pg_catalog."C",
    request_id text NOT NULL COLLATE pg_catalog."C",
    job_id text NOT NULL COLLATE pg_catalog."C",
    fingerprint text NOT NULL
);
CREATE TABLE schema_version (
    version bigint NOT NULL
);
CREATE TABLE shards (
    job_id text NOT NULL COLLATE pg_catalog."C",
    phase bigint NOT NULL,
    number bigint NOT NULL,
    first_chunk bigint NOT NULL,
    end_chunk bigint NOT NULL,
    outcome bigint NOT NULL,
    token bigint NOT NULL,
    attempts bigint NOT NULL,
    worker text NOT NULL,
    error bytea NOT NULL,
    digests bytea NOT NULL,
    time_us bigint NOT NULL
)
PARTITION BY RANGE (job_id);
CREATE TABLE shards_06610e82134000_0661229feaa000 (
    job_id text NOT NULL COLLATE pg_catalog."C",
    phase bigint NOT NULL,
    number bigint NOT NULL,
    first_chunk bigint NOT NULL,
    end_chunk bigint NOT NULL,
    outcome bigint NOT NULL,
    token bigint NOT NULL,
    attempts bigint NOT NULL,
    worker text NOT NULL,
    error bytea NOT NULL,
    digests bytea NOT NULL,
    time_us bigint NOT NULL
);
CREATE TABLE shards_0661229feaa000_066136bdc20000 (
    job_id text NOT NULL COLLATE pg_catalog."C",
    phase bigint NOT NULL,
    number bigint NOT NULL,
    first_chunk bigint NOT NULL,
    end_chunk bigint NOT NULL,
    outcome bigint NOT NULL,
    token bigint NOT NULL,
    attempts bigint NOT NULL,
    worker text NOT NULL,
    error bytea NOT NULL,
    digests bytea NOT NULL,
    time_us bigint NOT NULL
);
CREATE TABLE shards_066136bdc20000_06614adb996000 (
    job_id text NOT NULL COLLATE pg_catalog."C",
    phase bigint NOT NULL,
    number bigint NOT NULL,
    first_chunk bigint NOT NULL,
    end_chunk bigint NOT NULL,
    outcome bigint NOT NULL,
    token bigint NOT NULL,
    attempts bigint NOT NULL,
    worker text NOT NULL,
    error bytea NOT NULL,
    digests bytea NOT NULL,
    time_us bigint NOT NULL
);
CREATE TABLE shards_default (
    job_id text NOT NULL COLLATE pg_catalog."C",
    phase bigint NOT NULL,
    number bigint NOT NULL,
    first_chunk bigint NOT NULL,
    end_chunk bigint NOT NULL,
    outcome bigint NOT NULL,
    token bigint NOT NULL,
    attempts bigint NOT NULL,
    worker text NOT NULL,
    error bytea NOT NULL,
    digests bytea NOT NULL,
    time_us bigint NOT NULL
);
CREATE SEQUENCE tokens
    START WITH 1
    INCREMENT BY 1
    NO MINVALUE
    NO MAXVALUE
    CACHE 1;
ALTER TABLE ONLY events ATTACH PARTITION events_06610e82134000_0661229feaa000 FOR VALUES FROM ('06610e82134000') TO ('0661229feaa000');
ALTER TABLE ONLY events ATTACH PARTITION events_0661229feaa000_066136bdc20000 FOR VALUES FROM ('0661229feaa000') TO ('066136bdc20000');
ALTER TABLE ONLY events ATTACH PARTITION events_066136bdc20000_06614adb996000 FOR VALUES FROM ('066136bdc20000') TO ('06614adb996000');
ALTER TABLE ONLY events ATTACH PARTITION events_default DEFAULT;
ALTER TABLE ONLY jobs ATTACH PARTITION jobs_06610e82134000_0661229feaa000 FOR VALUES FROM ('06610e82134000') TO ('0661229feaa000');
ALTER TABLE ONLY jobs ATTACH PARTITION jobs_0661229feaa000_066136bdc20000 FOR VALUES FROM ('0661229feaa000') TO ('066136bdc20000');
ALTER TABLE ONLY jobs ATTACH PARTITION jobs_066136bdc20000_06614adb996000 FOR VALUES FROM ('066136bdc20000') TO ('06614adb996000');
ALTER TABLE ONLY jobs ATTACH PARTITION jobs_default DEFAULT;
ALTER TABLE ONLY shards ATTACH PARTITION shards_06610e82134000_0661229feaa000 FOR VALUES FROM ('06610e82134000') TO ('0661229feaa000');
ALTER TABLE ONLY shards ATTACH PARTITION shards_0661229feaa000_066136bdc20000 FOR VALUES FROM ('0661229feaa000') TO ('066136bdc20000');
ALTER TABLE ONLY shards ATTACH PARTITION shards_066136bdc20000_06614adb996000 FOR VALUES FROM ('066136bdc20000') TO ('06614adb996000');
ALTER TABLE ONLY shards ATTACH PARTITION shards_default DEFAULT;
INSERT INTO counters VALUES ('compacted', 0);
INSERT INTO counters VALUES ('probe', 1795637924156763);
INSERT INTO counters VALUES ('revision', 12);
INSERT INTO events_06610e82134000_0661229feaa000 VALUES (1, 1, '06611f88773d4a187efd2edb', 'default', 1, 1, 1, 0, 0, 1, 0, 0, 1795637921660234);
INSERT INTO events_06610e82134000_0661229feaa000 VALUES (2, 2, '06611f88773d4a187efd2edb', 'default', 2, 2, 2, 0, 0, 1, 0, 0, 1795637921688150);
INSERT INTO events_06610e82134000_0661229feaa000 VALUES (3, 3, '06611f88773d4a187efd2edb', 'default', 3, 3, 2, 18, 0, 5, 0, 0, 1795637922074998);
INSERT INTO events_06610e82134000_0661229feaa000 VALUES (4, 4, '06611f88773d4a187efd2edb', 'default', 4, 4, 2, 18, 4, 5, 1, 0, 1795637922266643);
INSERT INTO events_06610e82134000_0661229feaa000 VALUES (5, 5, '06611f88773d4a187efd2edb', 'default', 5, 4, 2, 18, 8, 5, 2, 0, 1795637922327014);
INSERT INTO events_06610e82134000_0661229feaa000 VALUES (6, 6, '06611f88773d4a187efd2edb', 'default', 6, 4, 2, 18, 12, 5, 3, 0, 1795637922386596);
INSERT INTO events_06610e82134000_0661229feaa000 VALUES (7, 7, '06611f88773d4a187efd2edb', 'default', 7, 4, 2, 18, 16, 5, 4, 0, 1795637922522667);
INSERT INTO events_06610e82134000_0661229feaa000 VALUES (8, 8, '06611f88773d4a187efd2edb', 'default', 8, 4, 2, 18, 18, 5, 5, 0, 1795637922630582);
INSERT INTO events_06610e82134000_0661229feaa000 VALUES (9, 9, '06611f88773d4a187efd2edb', 'default', 9, 6, 3, 18, 18, 5, 5, 0, 1795637922630582);
INSERT INTO events_06610e82134000_0661229feaa000 VALUES (10, 10, '06611f88a4263518d014342c', 'default', 1, 1, 1, 0, 0, 1, 0, 0, 1795637924603445);
INSERT INTO events_06610e82134000_0661229feaa000 VALUES (11, 11, '06611f88aa1f04ca9a6a4b61', 'default', 1, 1, 1, 0, 0, 1, 0, 0, 1795637924994820);
INSERT INTO events_06610e82134000_0661229feaa000 VALUES (12, 12, '06611f88aa1f04ca9a6a4b61', 'default', 2, 6, 5, 0, 0, 1, 0, 1, 1795637925671749);
INSERT INTO jobs_06610e82134000_0661229feaa000 VALUES ('06611f88a4263518d014342c', 'default', '\x6c696e6b', '\x0abd01280130015ab6010a1a0a0472696e673a1209000000000000f03f11333333333333d33f0a2e0a096c6f6e672072696e679201200a0472696e671218000000000000f83f000000000000f03f000000000000f03f0a520a056f746865729201480a096c6f6e672072696e671a18000000000000f03f000000000000000000000000000000002100000000008056402a18333333333333fb3f000000000000000000000000000000000a146a120a096c6f6e672072696e670a056f74686572120308901c2001', '\x', '', -5, 3, 1, 0, 1, '\x', 3600000000, 9223372036854775807, 1795637924603445, 9223372036854775807, 9223372036854775807, 9223372036854775807, 1795641524603445, 1795641524603445, 0, 0, 1, 0, 0, 0, '');
INSERT INTO jobs_06610e82134000_0661229feaa000 VALUES ('06611f88aa1f04ca9a6a4b61', 'default', '\x627261636b6574', '\x0ad302280130015acc020a2c0a05706c61746522230a18000000000000104000000000000000409a9999999999d93f119a9999999999b93f0a190a036261722a1209666666666666e63f11333333333333f33f0a280a04626f737392011f0a036261722a1800000000000000000000000000000000000000000000e03f0a1e0a04626f64796a160a05706c6174650a04626f737311333333333333d33f0a1a0a04626f72652a12099a9999999999d93f1100000000000010400a1b0a056472696c6c2a12099a9999999999c93f1100000000000000400a300a0a666972737420686f6c659201210a056472696c6c2a189a9999999999f9bf333333333333e3bf00000000000000000a350a05686f6c65739a012b0a0a666972737420686f6c6512030202011a189a99999999990940333333333333f33f00000000000000000a157a130a04626f64790a04626f72650a05686f6c65732001', '\x', '', 0, 3, 5, 0, 2, '\x0801122a6a6f6220303636313166383861613166303463613961366134623631207761732063616e63656c6c65641a460a28747970652e676f6f676c65617069732e636f6d2f676f6f676c652e7270632e4572726f72496e666f121a0a0d4a4f425f43414e43454c4c4544120974657473747265616d', 9223372036854775807, 9223372036854775807, 1795637924994820, 9223372036854775807, 9223372036854775807, 1795637925671749, 9223372036854775807, 9223372036854775807, 0, 0, 1, 0, 1, 0, '');
INSERT INTO jobs_06610e82134000_0661229feaa000 VALUES ('06611f88773d4a187efd2edb', 'default', '\x6c696e6b', '\x0abd01280130015ab6010a1a0a0472696e673a1209000000000000f03f11333333333333d33f0a2e0a096c6f6e672072696e679201200a0472696e671218000000000000f83f000000000000f03f000000000000f03f0a520a056f746865729201480a096c6f6e672072696e671a18000000000000f03f000000000000000000000000000000002100000000008056402a18333333333333fb3f000000000000000000000000000000000a146a120a096c6f6e672072696e670a056f74686572', '\x0af3020a406364303363356139646635666666646361303931633165656666336631333134353362376638633033633534313439613739396366393834663661323863373612c80119676666666666a63f2801300138015ab6010a1a0a0472696e673a1209000000000000f03f11333333333333d33f0a2e0a096c6f6e672072696e679201200a0472696e671218000000000000f83f000000000000f03f000000000000f03f0a520a056f746865729201480a096c6f6e672072696e671a18000000000000f03f000000000000000000000000000000002100000000008056402a18333333333333fb3f000000000000000000000000000000000a146a120a096c6f6e672072696e670a056f7468657218c3af0620c8f31d281230013801420909010000000000ec3f4a3a0a1b099a99999999f900c0110100000000c0f6bf190100000000c0f6bf121b099a99999999f90e40110100000000c0f63f190100000000c0f63f51676666666666a63f58018001a4f3aa04120e220a08d8e30410ecb10218022a00', '
night=monday
', 0, 3, 3, 2, 9, '\x', 9223372036854775807, 9223372036854775807, 1795637921660234, 1795637921688150, 1795637922074998, 1795637922630582, 9223372036854775807, 9223372036854775807, 18, 18, 5, 5, 0, 0, '');
INSERT INTO queue VALUES ('06611f88a4263518d014342c', 0, 0, 0, 0, -5, 'default', 0, 0, '', 0, 0, 0);
INSERT INTO requests VALUES ('default', '7fe56680b25377ee5d558bdce5ce384ced72e33a', '06611f88773d4a187efd2edb', '982072b61d6b8813c5974c855c6ce38ab1b25e8b03f798a5c426aa9bd1f12ade');
INSERT INTO requests VALUES ('default', 'b3206b9012d746d23ee9ed2faf782296094b9209', '06611f88a4263518d014342c', '43db3b9e11a4130106084870322a735e0dde160bb5fc617e4e63a147a5f78ba7');
INSERT INTO requests VALUES ('default', '4fc22514876aa53d9a5940d84a6cb42567eb4323', '06611f88aa1f04ca9a6a4b61', 'd7a7f9af412ac08552457deb60cd28ec62cf8560ccb5d885c225b41d599b95b3');
INSERT INTO schema_version VALUES (2);
INSERT INTO shards_06610e82134000_0661229feaa000 VALUES ('06611f88773d4a187efd2edb', 0, 0, 0, 0, 1, 1, 1, 'vm:4547', '\x', '\x', 1795637922074998);
INSERT INTO shards_06610e82134000_0661229feaa000 VALUES ('06611f88773d4a187efd2edb', 2, 0, 0, 4, 1, 2, 1, 'vm:4547', '\x', '\x96682a53f6b7752ccec6dd610ed1442216bb8535c339571005f00c4d72967234f8d7688772e68ddb34bcf65fbe76e28703079d72498ba1de85572a7913dffdf8b802477a5edebcb35dbb19defbdbe1ca3017b78ca8d7d3ed32a2c9494a0468f260843ff588b790a66ede8a325c498899c98d03af6a7b4dd883e2eab27af3031b', 1795637922266643);
INSERT INTO shards_06610e82134000_0661229feaa000 VALUES ('06611f88773d4a187efd2edb', 2, 1, 4, 8, 1, 3, 1, 'vm:4547', '\x', '\xabfdc9a5570833940c0c4a23607bbd4903b6214bc2c627abc3e1047373b21a72a890365b1fa9c913ecf2bede5e63dc49b5eef4a9b501d5930293e63f6e9316eb53e1f5fd2c578dbae84bc47dba0974ab56dd39c4adfe3e9bc088799232fc3aaadcc0b4ae26b25b10e07987ebaa1d40cbb1a4fcb35246182d96d1ce5dd106d302', 1795637922327014);
INSERT INTO shards_06610e82134000_0661229feaa000 VALUES ('06611f88773d4a187efd2edb', 2, 2, 8, 12, 1, 4, 1, 'vm:4547', '\x', '\x9ad1665e45d7ba2a292e6ca199e20cd04c69fd7eb40625bf3d255ed3dbbcb4f4a534c624f39b153a45415b8d40c25268651d38e8de13ecf71c0363caf3f3ae25f699d41902caa829961c75af9158b5b3a25d13aa5dbcadb7166c929fe184193483e915f6ca8fb92d028f94322c6042facf3cd5770ba418e0f93c83d010e7666c', 1795637922386596);
INSERT INTO shards_06610e82134000_0661229feaa000 VALUES ('06611f88773d4a187efd2edb', 2, 3, 12, 16, 1, 5, 1, 'vm:4547', '\x', '\xfcf38238298e1f8f93340078b42594ec0fef83861806bc2cb4456b39362b0659a11fe73ff312699fb09bec3e43609895945f4049907fb75b665a76fc39304cb74f9b76b373c8c5325bb6879879be4433ed62b49629b85e7482860c623e9e7c729b059cd41b488041b1dd7e9e1ec340cdd5461a0c6df2f5b06421a8303009ec54', 1795637922522667);
INSERT INTO shards_06610e82134000_0661229feaa000 VALUES ('06611f88773d4a187efd2edb', 2, 4, 16, 18, 1, 6, 1, 'vm:4547', '\x', '\xdc7cc1152a93890ed84577a50c2d1b5b3d2dfd115a09ba202407a0d047b622dbbce061f09bd9b59b520e9bb050c1e437c47ed91f09e9da6087d2cdb60a6ae0cf', 1795637922630582);
INSERT INTO shards_06610e82134000_0661229feaa000 VALUES ('06611f88aa1f04ca9a6a4b61', 0, 0, 0, 0, 2, 0, 0, '', '\x0801122a6a6f6220303636313166383861613166303463613961366134623631207761732063616e63656c6c65641a460a28747970652e676f6f676c65617069732e636f6d2f676f6f676c652e7270632e4572726f72496e666f121a0a0d4a4f425f43414e43454c4c4544120974657473747265616d', '\x', 1795637925671749);
SELECT pg_catalog.setval('event_ids', 12, true);
SELECT pg_catalog.setval('tokens', 6, true);
ALTER TABLE ONLY counters
    ADD CONSTRAINT counters_pkey PRIMARY KEY (name);
ALTER TABLE ONLY jobs
    ADD CONSTRAINT jobs_pkey PRIMARY KEY (id);
ALTER TABLE ONLY jobs_06610e82134000_0661229feaa000
    ADD CONSTRAINT jobs_06610e82134000_0661229feaa000_pkey PRIMARY KEY (id);
ALTER TABLE ONLY jobs_0661229feaa000_066136bdc20000
    ADD CONSTRAINT jobs_0661229feaa000_066136bdc20000_pkey PRIMARY KEY (id);
ALTER TABLE ONLY jobs_066136bdc20000_06614adb996000
    ADD CONSTRAINT jobs_066136bdc20000_06614adb996000_pkey PRIMARY KEY (id);
ALTER TABLE ONLY jobs_default
    ADD CONSTRAINT jobs_default_pkey PRIMARY KEY (id);
ALTER TABLE ONLY queue
    ADD CONSTRAINT queue_pkey PRIMARY KEY (job_id, phase, number);
ALTER TABLE ONLY requests
    ADD CONSTRAINT requests_pkey PRIMARY KEY (space, request_id);
ALTER TABLE ONLY shards
    ADD CONSTRAINT shards_pkey PRIMARY KEY (job_id, phase, number);
ALTER TABLE ONLY shards_06610e82134000_0661229feaa000
    ADD CONSTRAINT shards_06610e82134000_0661229feaa000_pkey PRIMARY KEY (job_id, phase, number);
ALTER TABLE ONLY shards_0661229feaa000_066136bdc20000
    ADD CONSTRAINT shards_0661229feaa000_066136bdc20000_pkey PRIMARY KEY (job_id, phase, number);
ALTER TABLE ONLY shards_066136bdc20000_06614adb996000
    ADD CONSTRAINT shards_066136bdc20000_06614adb996000_pkey PRIMARY KEY (job_id, phase, number);
ALTER TABLE ONLY shards_default
    ADD CONSTRAINT shards_default_pkey PRIMARY KEY (job_id, phase, number);
CREATE INDEX events_new ON ONLY events USING btree (id) WHERE (revision = 0);
CREATE INDEX events_06610e82134000_0661229feaa000_id_idx ON events_06610e82134000_0661229feaa000 USING btree (id) WHERE (revision = 0);
CREATE INDEX events_of_job ON ONLY events USING btree (job_id, revision);
CREATE INDEX events_06610e82134000_0661229feaa000_job_id_revision_idx ON events_06610e82134000_0661229feaa000 USING btree (job_id, revision);
CREATE INDEX events_by_revision ON ONLY events USING btree (revision);
CREATE INDEX events_06610e82134000_0661229feaa000_revision_idx ON events_06610e82134000_0661229feaa000 USING btree (revision);
CREATE INDEX events_of_space ON ONLY events USING btree (space, revision);
CREATE INDEX events_06610e82134000_0661229feaa000_space_revision_idx ON events_06610e82134000_0661229feaa000 USING btree (space, revision);
CREATE INDEX events_0661229feaa000_066136bdc20000_id_idx ON events_0661229feaa000_066136bdc20000 USING btree (id) WHERE (revision = 0);
CREATE INDEX events_0661229feaa000_066136bdc20000_job_id_revision_idx ON events_0661229feaa000_066136bdc20000 USING btree (job_id, revision);
CREATE INDEX events_0661229feaa000_066136bdc20000_revision_idx ON events_0661229feaa000_066136bdc20000 USING btree (revision);
CREATE INDEX events_0661229feaa000_066136bdc20000_space_revision_idx ON events_0661229feaa000_066136bdc20000 USING btree (space, revision);
CREATE INDEX events_066136bdc20000_06614adb996000_id_idx ON events_066136bdc20000_06614adb996000 USING btree (id) WHERE (revision = 0);
CREATE INDEX events_066136bdc20000_06614adb996000_job_id_revision_idx ON events_066136bdc20000_06614adb996000 USING btree (job_id, revision);
CREATE INDEX events_066136bdc20000_06614adb996000_revision_idx ON events_066136bdc20000_06614adb996000 USING btree (revision);
CREATE INDEX events_066136bdc20000_06614adb996000_space_revision_idx ON events_066136bdc20000_06614adb996000 USING btree (space, revision);
CREATE INDEX events_default_id_idx ON events_default USING btree (id) WHERE (revision = 0);
CREATE INDEX events_default_job_id_revision_idx ON events_default USING btree (job_id, revision);
CREATE INDEX events_default_revision_idx ON events_default USING btree (revision);
CREATE INDEX events_default_space_revision_idx ON events_default USING btree (space, revision);
CREATE INDEX jobs_finished ON ONLY jobs USING btree (finish_us) WHERE (state >= 3);
CREATE INDEX jobs_06610e82134000_0661229feaa000_finish_us_idx ON jobs_06610e82134000_0661229feaa000 USING btree (finish_us) WHERE (state >= 3);
CREATE INDEX jobs_with_trouble ON ONLY jobs USING btree (id) WHERE ((dead_shards + alarms) > 0);
CREATE INDEX jobs_06610e82134000_0661229feaa000_id_idx ON jobs_06610e82134000_0661229feaa000 USING btree (id) WHERE ((dead_shards + alarms) > 0);
CREATE INDEX jobs_queued ON ONLY jobs USING btree (rank, id) WHERE (state = 1);
CREATE INDEX jobs_06610e82134000_0661229feaa000_rank_id_idx ON jobs_06610e82134000_0661229feaa000 USING btree (rank, id) WHERE (state = 1);
CREATE INDEX jobs_inputs ON ONLY jobs USING btree (space, input) WHERE (state <= 2);
CREATE INDEX jobs_06610e82134000_0661229feaa000_space_input_idx ON jobs_06610e82134000_0661229feaa000 USING btree (space, input) WHERE (state <= 2);
CREATE INDEX jobs_by_state ON ONLY jobs USING btree (state, id);
CREATE INDEX jobs_06610e82134000_0661229feaa000_state_id_idx ON jobs_06610e82134000_0661229feaa000 USING btree (state, id);
CREATE INDEX jobs_to_stop ON ONLY jobs USING btree (stop_us) WHERE (state <= 2);
CREATE INDEX jobs_06610e82134000_0661229feaa000_stop_us_idx ON jobs_06610e82134000_0661229feaa000 USING btree (stop_us) WHERE (state <= 2);
CREATE INDEX jobs_0661229feaa000_066136bdc20000_finish_us_idx ON jobs_0661229feaa000_066136bdc20000 USING btree (finish_us) WHERE (state >= 3);
CREATE INDEX jobs_0661229feaa000_066136bdc20000_id_idx ON jobs_0661229feaa000_066136bdc20000 USING btree (id) WHERE ((dead_shards + alarms) > 0);
CREATE INDEX jobs_0661229feaa000_066136bdc20000_rank_id_idx ON jobs_0661229feaa000_066136bdc20000 USING btree (rank, id) WHERE (state = 1);
CREATE INDEX jobs_0661229feaa000_066136bdc20000_space_input_idx ON jobs_0661229feaa000_066136bdc20000 USING btree (space, input) WHERE (state <= 2);
CREATE INDEX jobs_0661229feaa000_066136bdc20000_state_id_idx ON jobs_0661229feaa000_066136bdc20000 USING btree (state, id);
CREATE INDEX jobs_0661229feaa000_066136bdc20000_stop_us_idx ON jobs_0661229feaa000_066136bdc20000 USING btree (stop_us) WHERE (state <= 2);
CREATE INDEX jobs_066136bdc20000_06614adb996000_finish_us_idx ON jobs_066136bdc20000_06614adb996000 USING btree (finish_us) WHERE (state >= 3);
CREATE INDEX jobs_066136bdc20000_06614adb996000_id_idx ON jobs_066136bdc20000_06614adb996000 USING btree (id) WHERE ((dead_shards + alarms) > 0);
CREATE INDEX jobs_066136bdc20000_06614adb996000_rank_id_idx ON jobs_066136bdc20000_06614adb996000 USING btree (rank, id) WHERE (state = 1);
CREATE INDEX jobs_066136bdc20000_06614adb996000_space_input_idx ON jobs_066136bdc20000_06614adb996000 USING btree (space, input) WHERE (state <= 2);
CREATE INDEX jobs_066136bdc20000_06614adb996000_state_id_idx ON jobs_066136bdc20000_06614adb996000 USING btree (state, id);
CREATE INDEX jobs_066136bdc20000_06614adb996000_stop_us_idx ON jobs_066136bdc20000_06614adb996000 USING btree (stop_us) WHERE (state <= 2);
CREATE INDEX jobs_default_finish_us_idx ON jobs_default USING btree (finish_us) WHERE (state >= 3);
CREATE INDEX jobs_default_id_idx ON jobs_default USING btree (id) WHERE ((dead_shards + alarms) > 0);
CREATE INDEX jobs_default_rank_id_idx ON jobs_default USING btree (rank, id) WHERE (state = 1);
CREATE INDEX jobs_default_space_input_idx ON jobs_default USING btree (space, input) WHERE (state <= 2);
CREATE INDEX jobs_default_state_id_idx ON jobs_default USING btree (state, id);
CREATE INDEX jobs_default_stop_us_idx ON jobs_default USING btree (stop_us) WHERE (state <= 2);
CREATE INDEX queue_due ON queue USING btree (due_us) WHERE (state = 2);
CREATE INDEX queue_held ON queue USING btree (space) WHERE (state = 1);
CREATE INDEX queue_held_jobs ON queue USING btree (job_id) WHERE (state = 1);
CREATE INDEX queue_leased ON queue USING btree (lease_us) WHERE (state = 1);
CREATE INDEX queue_ready ON queue USING btree (rank, space, job_id, phase, number) WHERE (state = 0);
CREATE INDEX queue_ready_jobs ON queue USING btree (job_id) WHERE (state = 0);
CREATE INDEX requests_of_job ON requests USING btree (job_id);
ALTER INDEX events_new ATTACH PARTITION events_06610e82134000_0661229feaa000_id_idx;
ALTER INDEX events_of_job ATTACH PARTITION events_06610e82134000_0661229feaa000_job_id_revision_idx;
ALTER INDEX events_by_revision ATTACH PARTITION events_06610e82134000_0661229feaa000_revision_idx;
ALTER INDEX events_of_space ATTACH PARTITION events_06610e82134000_0661229feaa000_space_revision_idx;
ALTER INDEX events_new ATTACH PARTITION events_0661229feaa000_066136bdc20000_id_idx;
ALTER INDEX events_of_job ATTACH PARTITION events_0661229feaa000_066136bdc20000_job_id_revision_idx;
ALTER INDEX events_by_revision ATTACH PARTITION events_0661229feaa000_066136bdc20000_revision_idx;
ALTER INDEX events_of_space ATTACH PARTITION events_0661229feaa000_066136bdc20000_space_revision_idx;
ALTER INDEX events_new ATTACH PARTITION events_066136bdc20000_06614adb996000_id_idx;
ALTER INDEX events_of_job ATTACH PARTITION events_066136bdc20000_06614adb996000_job_id_revision_idx;
ALTER INDEX events_by_revision ATTACH PARTITION events_066136bdc20000_06614adb996000_revision_idx;
ALTER INDEX events_of_space ATTACH PARTITION events_066136bdc20000_06614adb996000_space_revision_idx;
ALTER INDEX events_new ATTACH PARTITION events_default_id_idx;
ALTER INDEX events_of_job ATTACH PARTITION events_default_job_id_revision_idx;
ALTER INDEX events_by_revision ATTACH PARTITION events_default_revision_idx;
ALTER INDEX events_of_space ATTACH PARTITION events_default_space_revision_idx;
ALTER INDEX jobs_finished ATTACH PARTITION jobs_06610e82134000_0661229feaa000_finish_us_idx;
ALTER INDEX jobs_with_trouble ATTACH PARTITION jobs_06610e82134000_0661229feaa000_id_idx;
ALTER INDEX jobs_pkey ATTACH PARTITION jobs_06610e82134000_0661229feaa000_pkey;
ALTER INDEX jobs_queued ATTACH PARTITION jobs_06610e82134000_0661229feaa000_rank_id_idx;
ALTER INDEX jobs_inputs ATTACH PARTITION jobs_06610e82134000_0661229feaa000_space_input_idx;
ALTER INDEX jobs_by_state ATTACH PARTITION jobs_06610e82134000_0661229feaa000_state_id_idx;
ALTER INDEX jobs_to_stop ATTACH PARTITION jobs_06610e82134000_0661229feaa000_stop_us_idx;
ALTER INDEX jobs_finished ATTACH PARTITION jobs_0661229feaa000_066136bdc20000_finish_us_idx;
ALTER INDEX jobs_with_trouble ATTACH PARTITION jobs_0661229feaa000_066136bdc20000_id_idx;
ALTER INDEX jobs_pkey ATTACH PARTITION jobs_0661229feaa000_066136bdc20000_pkey;
ALTER INDEX jobs_queued ATTACH PARTITION jobs_0661229feaa000_066136bdc20000_rank_id_idx;
ALTER INDEX jobs_inputs ATTACH PARTITION jobs_0661229feaa000_066136bdc20000_space_input_idx;
ALTER INDEX jobs_by_state ATTACH PARTITION jobs_0661229feaa000_066136bdc20000_state_id_idx;
ALTER INDEX jobs_to_stop ATTACH PARTITION jobs_0661229feaa000_066136bdc20000_stop_us_idx;
ALTER INDEX jobs_finished ATTACH PARTITION jobs_066136bdc20000_06614adb996000_finish_us_idx;
ALTER INDEX jobs_with_trouble ATTACH PARTITION jobs_066136bdc20000_06614adb996000_id_idx;
ALTER INDEX jobs_pkey ATTACH PARTITION jobs_066136bdc20000_06614adb996000_pkey;
ALTER INDEX jobs_queued ATTACH PARTITION jobs_066136bdc20000_06614adb996000_rank_id_idx;
ALTER INDEX jobs_inputs ATTACH PARTITION jobs_066136bdc20000_06614adb996000_space_input_idx;
ALTER INDEX jobs_by_state ATTACH PARTITION jobs_066136bdc20000_06614adb996000_state_id_idx;
ALTER INDEX jobs_to_stop ATTACH PARTITION jobs_066136bdc20000_06614adb996000_stop_us_idx;
ALTER INDEX jobs_finished ATTACH PARTITION jobs_default_finish_us_idx;
ALTER INDEX jobs_with_trouble ATTACH PARTITION jobs_default_id_idx;
ALTER INDEX jobs_pkey ATTACH PARTITION jobs_default_pkey;
ALTER INDEX jobs_queued ATTACH PARTITION jobs_default_rank_id_idx;
ALTER INDEX jobs_inputs ATTACH PARTITION jobs_default_space_input_idx;
ALTER INDEX jobs_by_state ATTACH PARTITION jobs_default_state_id_idx;
ALTER INDEX jobs_to_stop ATTACH PARTITION jobs_default_stop_us_idx;
ALTER INDEX shards_pkey ATTACH PARTITION shards_06610e82134000_0661229feaa000_pkey;
ALTER INDEX shards_pkey ATTACH PARTITION shards_0661229feaa000_066136bdc20000_pkey;
ALTER INDEX shards_pkey ATTACH PARTITION shards_066136bdc20000_06614adb996000_pkey;
ALTER INDEX shards_pkey ATTACH PARTITION shards_default_pkey;
