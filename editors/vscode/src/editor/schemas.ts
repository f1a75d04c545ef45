// Associates suites with their schema in the XML extension. That of rtf.toml is declared in
// package.json (`tomlValidation`).

import * as vscode from 'vscode';
import { globOf } from '../logic/suite-file';

const EXTENSION = 'redhat.vscode-xml';

interface Association {
    systemId: string;
    pattern: string;
}

/** The part of the XML extension's interface that is used. */
interface XmlExtension {
    addXMLFileAssociations(associations: Association[]): void;
    removeXMLFileAssociations(associations: Association[]): void;
}

export class SuiteSchema {
    private current: Association | undefined;

    constructor(private readonly context: vscode.ExtensionContext) {}

    /** Associates exactly these files with the schema of suites. */
    async associate(files: readonly string[]): Promise<void> {
        const extension = vscode.extensions.getExtension<XmlExtension>(EXTENSION);
        if (extension === undefined) return;
        const schema = vscode.Uri.joinPath(this.context.extensionUri, 'schemas', 'suite.xsd');
        const wanted = { systemId: schema.toString(), pattern: globOf(files) };
        if (this.current?.pattern === wanted.pattern) return;
        const before = this.current;
        this.current = wanted;
        const xml = await extension.activate();
        if (before !== undefined) xml.removeXMLFileAssociations([before]);
        if (files.length > 0) xml.addXMLFileAssociations([wanted]);
    }
}
