import { expect, test } from 'vitest';
import { globOf, isSuite } from './suite-file';

test.each([
    '<suite name="arm"/>',
    '\uFEFF<?xml version="1.0"?>\n<!-- <robot/> -->\n<suite\n  name="arm">',
    '<!DOCTYPE suite SYSTEM "x.dtd"><suite>',
])('%s is a suite', (text) => expect(isSuite(text)).toBe(true));

test.each([
    '',
    '<robot name="arm"/>',
    '<suites/>',
    '<testsuite/>',
    '<!-- <suite> --><a/>',
    'suite',
])('%s is not a suite', (text) => expect(isSuite(text)).toBe(false));

test('a glob matches exactly the given files', () => {
    expect(globOf(['/a/arm.xml', '/b/[x].xml'])).toBe('{/a/arm.xml,/b/\\[x\\].xml}');
});
