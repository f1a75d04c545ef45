/** A map that keeps the entries which were set last. */
export class Recent<T> extends Map<string, T> {
    constructor(private readonly most: number) {
        super();
    }

    override set(key: string, value: T): this {
        this.delete(key);
        super.set(key, value);
        const [oldest = key] = this.keys();
        if (this.size > this.most) this.delete(oldest);
        return this;
    }
}
