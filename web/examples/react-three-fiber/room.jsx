import { useGLTF } from '@react-three/drei';
import { useThree } from '@react-three/fiber';
import { useEffect } from 'react';
import { PhatexturesExtension, bakedLightOf, prepareLights } from 'phatextures';

const readLight = (loader) => loader.register((parser) => new PhatexturesExtension(parser));

// `useGLTF` keeps what it has read. What is on the GPU is freed here, and made again when it is drawn again.
export function Room({ url }) {
    const room = useGLTF(url, true, true, readLight),
        { gl, scene, camera } = useThree();
    useEffect(() => {
        prepareLights(gl, scene);
        camera.position.setFromMatrixPosition(room.cameras[0].matrixWorld);
        return () => bakedLightOf(room)?.dispose();
    }, [gl, scene, camera, room]);
    return <primitive object={room.scene} />;
}
