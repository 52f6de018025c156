// `await` at the top of modules needs browsers of 2022.
export default { build: { target: 'es2022' } };
